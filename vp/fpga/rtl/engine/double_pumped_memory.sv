// A component of a partition's copy of d: block RAMs at twice the engine's clock, so that their two
// ports serve four accesses a clock (accel::DirectionMemory::double_pumped). A product reads the
// nodes of a package; a pass reads Lanes nodes and writes Lanes, which have addresses in sequence.
//
// Addresses are seen at an edge; words come with the next one. This is what the memory does as seen
// from the engine's clock. A synthesis puts a vendor's block with both its ports and a clock of
// twice the frequency in its place: tools infer neither from a description. `ECP5` does so for that
// family. No word is read in the clock after the one that wrote it, and between a pass and a product
// there is a clock with neither.
`default_nettype none

module double_pumped_memory #(
    parameter int Width = 16,
    parameter int AddressBits = 9,
    parameter int Reads = 4,
    parameter int Lanes = 2,
    // A product's come out of registers, without logic: of use to a synthesis.
    parameter bit AddressesInRegisters = 1'b1
) (
    input wire clock,
`ifdef ECP5
    input wire clock2,
`endif
    input wire product,  // whose addresses are read
    input wire [Reads-1:0][AddressBits-1:0] package_address,
    input wire [AddressBits-1:0] pass_address,  // of lane 0
    output wire [Reads-1:0][Width-1:0] word,
    output wire [Lanes-1:0][Width-1:0] pass_word,
    input wire [Lanes-1:0] write,
    input wire [AddressBits-1:0] write_address,
    input wire [Lanes-1:0][Width-1:0] write_word
);

`ifdef ECP5
  ecp5_double_pumped_memory #(
      .Width(Width),
      .AddressBits(AddressBits),
      .Reads(Reads),
      .Lanes(Lanes),
      .AddressesInRegisters(AddressesInRegisters)
  ) memory (
      .clock,
      .clock2,
      .product,
      .package_address,
      .pass_address,
      .word,
      .pass_word,
      .write,
      .write_address,
      .write_word
  );
`else
  wire unused = &{1'b0, AddressesInRegisters};
  logic [Width-1:0] cells[2**AddressBits];
  logic [Reads-1:0][AddressBits-1:0] address;
  logic [Reads-1:0][Width-1:0] read;
  assign word = read;
  assign pass_word = read[Lanes-1:0];

  always_ff @(posedge clock) begin
    for (int i = 0; i < Reads; ++i) begin
      if (i < Lanes && !product) address[i] <= pass_address + AddressBits'(i);
      else address[i] <= package_address[i];
      read[i] <= cells[address[i]];
    end
    for (int l = 0; l < Lanes; ++l) begin
      if (write[l]) cells[write_address+AddressBits'(l)] <= write_word[l];
    end
  end
`endif

endmodule

`default_nettype wire
