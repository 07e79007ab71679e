// The memory of a component of d as the engine's clock sees it, and that of an ECP5's blocks with a
// second clock, side by side: what the engine takes from each at the same edge.
`default_nettype none

module double_pumped_pair #(
    parameter int Width = 16,
    parameter int AddressBits = 10,
    parameter int Reads = 4,
    parameter int Lanes = 2,
    parameter bit AddressesInRegisters = 1'b1
) (
    input wire clock,
    input wire clock2,
    input wire product,
    input wire [3:0][AddressBits-1:0] package_address,
    input wire [AddressBits-1:0] pass_address,
    input wire [1:0] write,
    input wire [AddressBits-1:0] write_address,
    input wire [1:0][Width-1:0] write_word,
    output logic [Reads-1:0][Width-1:0] word,
    output logic [Lanes-1:0][Width-1:0] pass_word,
    output logic [Reads-1:0][Width-1:0] ecp5_word,
    output logic [Lanes-1:0][Width-1:0] ecp5_pass_word
);

  wire [Reads-1:0][Width-1:0] words, ecp5_words;
  wire [Lanes-1:0][Width-1:0] pass_words, ecp5_pass_words;
  double_pumped_memory #(
      .Width(Width),
      .AddressBits(AddressBits),
      .Reads(Reads),
      .Lanes(Lanes),
      .AddressesInRegisters(AddressesInRegisters)
  ) behaviour (
      .clock,
      .product,
      .package_address(package_address[Reads-1:0]),
      .pass_address,
      .word(words),
      .pass_word(pass_words),
      .write(write[Lanes-1:0]),
      .write_address,
      .write_word(write_word[Lanes-1:0])
  );
  ecp5_double_pumped_memory #(
      .Width(Width),
      .AddressBits(AddressBits),
      .Reads(Reads),
      .Lanes(Lanes),
      .AddressesInRegisters(AddressesInRegisters)
  ) blocks (
      .clock,
      .clock2,
      .product,
      .package_address(package_address[Reads-1:0]),
      .pass_address,
      .word(ecp5_words),
      .pass_word(ecp5_pass_words),
      .write(write[Lanes-1:0]),
      .write_address,
      .write_word(write_word[Lanes-1:0])
  );
  always_ff @(posedge clock) begin
    word <= words;
    pass_word <= pass_words;
    ecp5_word <= ecp5_words;
    ecp5_pass_word <= ecp5_pass_words;
  end
  // Fewer reads and lanes take the first ones.
  wire unused = &{1'b0, package_address, write, write_word};

endmodule

`default_nettype wire
