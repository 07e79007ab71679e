// The memories of one component of a lane: x, r, b, q and the x before, each with a read and a write
// port. A node is in lane node mod Lanes, at address node / Lanes (engine::VectorMemories).
//
// Words come two clocks behind the edge at which an address is seen. The host writes x and b and
// reads x while no pass runs.
`default_nettype none

module vector_bank #(
    parameter int VectorBits = 16,
    parameter int ProductBits = 32,
    parameter int AddressBits = 9
) (
    input wire clock,
    input wire [AddressBits-1:0] read_address,
    input wire [AddressBits-1:0] b_read_address,  // a product reads b beside the rows
    output wire [VectorBits-1:0] x,
    output wire [VectorBits-1:0] r,
    output wire [VectorBits-1:0] b,
    output wire [VectorBits-1:0] previous,
    output wire [ProductBits-1:0] q,
    input wire x_write,
    input wire r_write,
    input wire [AddressBits-1:0] write_address,
    input wire [VectorBits-1:0] x_new,
    input wire [VectorBits-1:0] r_new,
    input wire previous_write,  // of the x that was read: the address is of that rank
    input wire [AddressBits-1:0] previous_address,
    input wire q_write,
    input wire [AddressBits-1:0] q_address,
    input wire [ProductBits-1:0] q_new,
    input wire host_x_write,
    input wire host_b_write,
    input wire [AddressBits-1:0] host_address,
    input wire [VectorBits-1:0] host_word
);

  block_memory #(
      .Width(VectorBits),
      .AddressBits(AddressBits)
  ) x_memory (
      .clock,
      .write(x_write || host_x_write),
      .write_address(host_x_write ? host_address : write_address),
      .write_word(host_x_write ? host_word : x_new),
      .read_address,
      .word(x)
  );
  block_memory #(
      .Width(VectorBits),
      .AddressBits(AddressBits)
  ) r_memory (
      .clock,
      .write(r_write),
      .write_address,
      .write_word(r_new),
      .read_address,
      .word(r)
  );
  block_memory #(
      .Width(VectorBits),
      .AddressBits(AddressBits)
  ) b_memory (
      .clock,
      .write(host_b_write),
      .write_address(host_address),
      .write_word(host_word),
      .read_address(b_read_address),
      .word(b)
  );
  block_memory #(
      .Width(VectorBits),
      .AddressBits(AddressBits)
  ) previous_memory (
      .clock,
      .write(previous_write),
      .write_address(previous_address),
      .write_word(x),
      .read_address,
      .word(previous)
  );
  block_memory #(
      .Width(ProductBits),
      .AddressBits(AddressBits)
  ) q_memory (
      .clock,
      .write(q_write),
      .write_address(q_address),
      .write_word(q_new),
      .read_address,
      .word(q)
  );

endmodule

`default_nettype wire
