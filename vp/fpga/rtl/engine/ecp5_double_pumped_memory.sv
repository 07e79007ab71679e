// double_pumped_memory of an ECP5's block RAMs, with a clock of twice the frequency whose every
// other edge is one of the engine's clock.
//
// The blocks have registers directly before and behind their ports, so that the net to or from a
// block has all of half a clock. With t an edge of the engine's clock, in its clocks, and a product's
// addresses that are seen at t, in registers since t - 1:
//   t - 1/2  the ports' registers take the addresses of the first two reads
//   t        both ports take these, and the ports' registers those of the other two
//   t + 1/2  the first two words are in the output registers, and both ports take the other two
//   t + 1    the first two words are kept, and the other two are in the output registers
//   t + 3/2  the other two are kept, too
// A pass reads at t + 1/2, and the output registers have its words from t + 1 to t + 2. What it
// writes at t is in registers then, is in the ports' at t + 1/2, and is written at t + 1, at which a
// product that is seen there reads: hence the clock between them. The pass' addresses and `product`
// are seen at t only; to a tool that is not told so they have half a clock instead of a whole one.
//
// Addresses behind logic, those of a crossbar, are not there half a clock earlier. They have a
// register for each half, and the ports a multiplexer of the two:
//   t + 1/2  both ports take the addresses of the first two reads
//   t + 1    their words are in the output registers; both ports take the other two addresses, or
//            those of the words that are written
//   t + 3/2  a product's first two words are kept, and the other two are in the output registers;
//            in a pass the output registers stay as they are
`default_nettype none

module ecp5_double_pumped_memory #(
    parameter int Width = 16,
    parameter int AddressBits = 9,
    parameter int Reads = 4,
    parameter int Lanes = 2,
    parameter bit AddressesInRegisters = 1'b1  // a product's
) (
    input wire clock,
    input wire clock2,  // twice as fast
    input wire product,
    input wire [Reads-1:0][AddressBits-1:0] package_address,
    input wire [AddressBits-1:0] pass_address,
    output wire [Reads-1:0][Width-1:0] word,
    output wire [Lanes-1:0][Width-1:0] pass_word,
    input wire [Lanes-1:0] write,
    input wire [AddressBits-1:0] write_address,
    input wire [Lanes-1:0][Width-1:0] write_word
);

  // ---- Which half of the engine's clock it is: an edge of the engine's clock changes `toggle`, and
  // the next one of the other clock sees that. Behind that one `second` is set, until the next edge
  // of the engine's clock.
  logic toggle, seen, second;
  always_ff @(posedge clock) toggle <= !toggle;
  always_ff @(posedge clock2) begin
    seen <= toggle;
    second <= toggle != seen;
  end

  // ---- What is written.
  logic [1:0][Width-1:0] written_word;
  logic [1:0] written;
  always_ff @(posedge clock) begin
    written <= '0;
    written_word <= '0;
    for (int l = 0; l < Lanes; ++l) begin
      written[l] <= write[l];
      written_word[l] <= write_word[l];
    end
  end

  wire [1:0][Width-1:0] out;
  assign pass_word = out[Lanes-1:0];

  if (AddressesInRegisters) begin : g_early
    // A product of up to two reads makes them where a pass does.
    localparam bit Both = Reads > 2;
    logic [1:0][AddressBits-1:0] written_address;
    always_ff @(posedge clock) begin
      written_address <= '0;
      for (int l = 0; l < Lanes; ++l) written_address[l] <= write_address + AddressBits'(l);
    end

    logic [1:0][AddressBits-1:0] first_address, second_address, port_address;
    logic [1:0] writes;
    logic registers;
    always_comb begin
      first_address = written_address;
      second_address = '0;
      for (int i = 0; i < Reads; ++i) begin
        if (Both && i < 2) begin
          if (!written[i]) first_address[i] = package_address[i];
        end else begin
          second_address[i%2] = package_address[i];
        end
      end
      for (int l = 0; l < Lanes; ++l) begin
        if (!product) second_address[l] = pass_address + AddressBits'(l);
      end
    end
    always_ff @(posedge clock2) begin
      port_address <= second ? second_address : first_address;
      writes <= second ? '0 : written;
      registers <= !second || (product && Both);
    end
    ecp5_memory #(
        .Width(Width),
        .AddressBits(AddressBits)
    ) memory (
        .clock(clock2),
        .write(writes),
        .address(port_address),
        .write_word(written_word),
        .registers,
        .word(out)
    );

    if (Both) begin : g_kept
      logic [1:0][Width-1:0] first_words;
      logic [Reads-3:0][Width-1:0] second_words;
      always_ff @(posedge clock) first_words <= out;
      always_ff @(posedge clock2) if (!second) second_words <= out[Reads-3:0];
      for (genvar i = 0; i < Reads; ++i) begin : g_word
        assign word[i] = i < 2 ? first_words[i] : second_words[i-2];
      end
    end else begin : g_whole
      assign word = out[Reads-1:0];
    end
  end else begin : g_late
    // What is seen at an edge of the engine's clock: for each port the addresses of both halves.
    logic [1:0][AddressBits-1:0] first_address, second_address;
    logic product1, product2;
    always_ff @(posedge clock) begin
      first_address <= '0;
      second_address <= '0;
      for (int i = 0; i < Reads; ++i) begin
        if (i < 2) first_address[i] <= package_address[i];
        else second_address[i-2] <= package_address[i];
      end
      for (int l = 0; l < Lanes; ++l) begin
        if (!product) first_address[l] <= pass_address + AddressBits'(l);
        if (write[l]) second_address[l] <= write_address + AddressBits'(l);
      end
      product1 <= product;
      product2 <= product1;
    end

    wire [1:0][AddressBits-1:0] port_address;
    for (genvar p = 0; p < 2; ++p) begin : g_port
      assign port_address[p] = second ? second_address[p] : first_address[p];
    end
    ecp5_memory #(
        .Width(Width),
        .AddressBits(AddressBits)
    ) memory (
        .clock(clock2),
        .write(written & {2{second}}),
        .address(port_address),
        .write_word(written_word),
        .registers(second || (product2 && Reads > 2)),
        .word(out)
    );

    if (Reads > 2) begin : g_kept
      logic [1:0][Width-1:0] kept;
      always_ff @(posedge clock2) if (!second) kept <= out;
      for (genvar i = 0; i < Reads; ++i) begin : g_word
        assign word[i] = i < 2 ? kept[i] : out[i-2];
      end
    end else begin : g_whole
      assign word = out[Reads-1:0];
    end
  end

endmodule

`default_nettype wire
