// A memory to which a component of d is dealt: of the kind that accelerator.direction_memory names,
// with `Ports` accesses a clock. A product reads as many words; a pass reads Lanes words and writes
// Lanes, which have addresses in sequence.
//
// Addresses are seen at an edge, and words come with the next one. What is written together with
// what is read needs no more than `Ports` accesses: the vector unit sees to that.
`default_nettype none

module direction_bank #(
    parameter int Width = 16,
    parameter int AddressBits = 9,
    parameter int Memory = 0,  // accel::DirectionMemory
    parameter int Reads = 4,   // up to 4 or, where packages stall, 2
    parameter int Lanes = 2,   // up to 2
    parameter bit AddressesInRegisters = 1'b1  // a product's
) (
    input wire clock,
`ifdef ECP5
    input wire clock2,
`endif
    input wire product,  // whose addresses are read
    input wire [Reads-1:0][AddressBits-1:0] package_address,
    input wire [AddressBits-1:0] pass_address,  // of the first lane
    output wire [Reads-1:0][Width-1:0] word,
    output wire [Lanes-1:0][Width-1:0] pass_word,
    input wire [Lanes-1:0] write,
    input wire [AddressBits-1:0] write_address,
    input wire [Lanes-1:0][Width-1:0] write_word
);

  if (Memory == 0) begin : g_double_pumped
    double_pumped_memory #(
        .Width(Width),
        .AddressBits(AddressBits),
        .Reads(Reads),
        .Lanes(Lanes),
        .AddressesInRegisters(AddressesInRegisters)
    ) memory (
        .clock,
`ifdef ECP5
        .clock2,
`endif
        .product,
        .package_address,
        .pass_address,
        .word,
        .pass_word,
        .write,
        .write_address,
        .write_word
    );
  end else begin : g_dual_port
`ifdef ECP5
    wire unused_clock = &{1'b0, clock2};
`endif
    // Copies with the same words, of which each has two ports. A pass reads the first one; with two
    // lanes both ports read or both write, with one the second port writes.
    localparam int Copies = Memory == 1 ? 2 : 1;
    logic [Copies-1:0][1:0] writes;
    logic [Copies-1:0][1:0][AddressBits-1:0] address;
    logic [1:0][Width-1:0] written;
    wire [Copies-1:0][1:0][Width-1:0] words;
    for (genvar p = 0; p < 2; ++p) begin : g_port
      localparam int Lane = Lanes == 2 ? p : 0;
      wire writes_here = write[Lane] && (Lanes == 2 || p == 1);
      always_ff @(posedge clock) written[p] <= write_word[Lane];
      for (genvar i = 0; i < Copies; ++i) begin : g_copy
        localparam int Read = 2 * i + p;
        always_ff @(posedge clock) begin
          writes[i][p] <= writes_here;
          if (writes_here) address[i][p] <= write_address + AddressBits'(Lane);
          else if (product && Read < Reads) address[i][p] <= package_address[Read<Reads?Read : 0];
          else address[i][p] <= pass_address + AddressBits'(Lane);
        end
        if (Read < Reads) begin : g_read
          assign word[Read] = words[i][p];
        end else begin : g_not_read
          wire unused = &{1'b0, words[i][p]};
        end
      end
    end
    for (genvar i = 0; i < Copies; ++i) begin : g_memory
      dual_port_memory #(
          .Width(Width),
          .AddressBits(AddressBits)
      ) memory (
          .clock,
          .write(writes[i]),
          .address(address[i]),
          .write_word(written),
          .word(words[i])
      );
    end
    assign pass_word = words[0][Lanes-1:0];
  end

endmodule

`default_nettype wire
