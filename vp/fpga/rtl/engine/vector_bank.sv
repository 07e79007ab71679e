// The memories of one component of a lane: x, r, b, q, the x before and with a preconditioner z and
// P^-1, each with a read and a write port. A node is in lane node mod Lanes, at address node / Lanes (engine::VectorMemories).
//
// Words come two clocks behind the edge at which an address is seen. The host writes x and b and
// reads x while no pass runs.
`default_nettype none

module vector_bank
  import engine_types::*;
#(
    parameter int Preconditioner = 0,  // of Jacobi, of blocks
    parameter int VectorBits = 16,
    parameter int ResidualBits = 16,
    parameter int ProductBits = 32,
    parameter int AddressBits = 9,
    localparam int InverseWords = inverse_words(Preconditioner),
    localparam int InverseWidth = inverse_bits(Preconditioner)
) (
    input wire clock,
    input wire [AddressBits-1:0] read_address,
    input wire [AddressBits-1:0] b_read_address,  // a product reads b beside the rows
    output wire [VectorBits-1:0] x,
    output wire [ResidualBits-1:0] r,
    output wire [ResidualBits-1:0] b,
    output wire [VectorBits-1:0] previous,
    output wire [ProductBits-1:0] q,
    output wire [ResidualBits-1:0] z,
    input wire x_write,
    input wire r_write,
    input wire [AddressBits-1:0] write_address,
    input wire [VectorBits-1:0] x_new,
    input wire [ResidualBits-1:0] r_new,
    input wire previous_write,  // of the x that was read: the address is of that rank
    input wire [AddressBits-1:0] previous_address,
    input wire q_write,
    input wire [AddressBits-1:0] q_address,
    input wire [ProductBits-1:0] q_new,
    input wire z_write,
    input wire [AddressBits-1:0] z_address,
    input wire [ResidualBits-1:0] z_new,
    input wire [AddressBits-1:0] inverse_read_address,
    output wire [InverseWords-1:0][InverseWidth-1:0] inverse,
    input wire inverse_write,
    input wire [AddressBits-1:0] inverse_address,
    input wire [InverseWords-1:0][InverseWidth-1:0] inverse_new,
    input wire host_x_write,
    input wire host_b_write,
    input wire [AddressBits-1:0] host_address,
    input wire [ResidualBits-1:0] host_word  // of x the lowest bits
);

  block_memory #(
      .Width(VectorBits),
      .AddressBits(AddressBits)
  ) x_memory (
      .clock,
      .write(x_write || host_x_write),
      .write_address(host_x_write ? host_address : write_address),
      .write_word(host_x_write ? host_word[VectorBits-1:0] : x_new),
      .read_address,
      .word(x)
  );
  block_memory #(
      .Width(ResidualBits),
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
      .Width(ResidualBits),
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
  if (Preconditioner != 0) begin : g_preconditioner
    block_memory #(
        .Width(ResidualBits),
        .AddressBits(AddressBits)
    ) z_memory (
        .clock,
        .write(z_write),
        .write_address(z_address),
        .write_word(z_new),
        .read_address,
        .word(z)
    );
    for (genvar k = 0; k < InverseWords; ++k) begin : g_word
      block_memory #(
          .Width(InverseWidth),
          .AddressBits(AddressBits)
      ) inverse_memory (
          .clock,
          .write(inverse_write),
          .write_address(inverse_address),
          .write_word(inverse_new[k]),
          .read_address(inverse_read_address),
          .word(inverse[k])
      );
    end
  end else begin : g_z_is_r
    assign z = r;
    assign inverse = '0;
    wire unused = &{1'b0, z_write, z_address, z_new, inverse_read_address, inverse_write,
                    inverse_address, inverse_new};
  end

endmodule

`default_nettype wire
