// A block RAM with two ports, each of which reads or writes a word at an edge. A word that is read
// is there behind the edge; no port reads what the other one writes at the same edge.
//
// A synthesis puts a vendor's block in its place: tools infer no memory with two writing ports.
// `ECP5` does so for that family.
`default_nettype none

module dual_port_memory #(
    parameter int Width = 16,
    parameter int AddressBits = 9
) (
    input wire clock,
    input wire [1:0] write,
    input wire [1:0][AddressBits-1:0] address,
    input wire [1:0][Width-1:0] write_word,
    output wire [1:0][Width-1:0] word
);

`ifdef ECP5
  ecp5_memory #(
      .Width(Width),
      .AddressBits(AddressBits),
      .OutputRegister(1'b0)
  ) memory (
      .clock,
      .write,
      .address,
      .write_word,
      .registers(1'b1),
      .word
  );
`else
  logic [1:0][Width-1:0] read;
  assign word = read;
  logic [Width-1:0] cells[2**AddressBits];
  always_ff @(posedge clock) begin
    for (int p = 0; p < 2; ++p) begin
      if (write[p]) cells[address[p]] <= write_word[p];
      else read[p] <= cells[address[p]];
    end
  end
`endif

endmodule

`default_nettype wire
