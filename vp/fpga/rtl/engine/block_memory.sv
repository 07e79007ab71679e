// A block RAM with a write port and a read port and with its output register: a word comes two
// clocks behind the edge at which its address is seen.
//
// The read port sees a word one clock after the edge that wrote it.
`default_nettype none

module block_memory #(
    parameter int Width = 16,
    parameter int AddressBits = 9
) (
    input wire clock,
    input wire write,
    input wire [AddressBits-1:0] write_address,
    input wire [Width-1:0] write_word,
    input wire [AddressBits-1:0] read_address,
    output wire [Width-1:0] word
);

`ifdef ECP5
  ecp5_block_memory #(
      .Width(Width),
      .AddressBits(AddressBits)
  ) memory (
      .clock,
      .write,
      .write_address,
      .write_word,
      .read_address,
      .word
  );
`else
  logic [Width-1:0] cells[2**AddressBits];
  logic [Width-1:0] read, read_before;
  assign word = read_before;

  always_ff @(posedge clock) begin
    if (write) cells[write_address] <= write_word;
    read <= cells[read_address];
    read_before <= read;
  end
`endif

endmodule

`default_nettype wire
