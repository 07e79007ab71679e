// double_pumped_memory of an ECP5's block RAMs, with a clock of twice the frequency whose every
// other edge is one of the engine's clock.
//
// With t an edge of the engine's clock, in its clocks, for addresses that are seen at t:
//   t + 1/2  both ports take the addresses of the first two reads
//   t + 1    their words are in the output registers; both ports take the other two addresses, or
//            those of the words that are written
//   t + 3/2  a product's first two words are kept, and the other two are in the output registers;
//            in a pass the output registers stay as they are, so that its words have a whole clock
//            on their way to the vector unit
`default_nettype none

module ecp5_double_pumped_memory #(
    parameter int Width = 16,
    parameter int AddressBits = 9,
    parameter int Reads = 4,
    parameter int Lanes = 2
) (
    input wire clock,
    input wire clock2,  // twice as fast
    input wire product,
    input wire [Reads-1:0][AddressBits-1:0] package_address,
    input wire [AddressBits-1:0] pass_address,
    output wire [Reads-1:0][Width-1:0] word,       // half a clock before the edge that takes them
    output wire [Lanes-1:0][Width-1:0] pass_word,
    input wire [Lanes-1:0] write,
    input wire [AddressBits-1:0] write_address,
    input wire [Lanes-1:0][Width-1:0] write_word
);

  // ---- What is seen at an edge of the engine's clock: for each port the addresses of both halves.
  logic [1:0][AddressBits-1:0] first_address, second_address;
  logic [1:0][Width-1:0] written_word;
  logic [1:0] written;
  logic product1, product2;
  logic toggle;
  always_ff @(posedge clock) begin
    first_address <= '0;
    second_address <= '0;
    written <= '0;
    written_word <= '0;
    for (int i = 0; i < Reads; ++i) begin
      if (i < 2) first_address[i] <= package_address[i];
      else second_address[i-2] <= package_address[i];
    end
    for (int l = 0; l < Lanes; ++l) begin
      if (!product) first_address[l] <= pass_address + AddressBits'(l);
      if (write[l]) second_address[l] <= write_address + AddressBits'(l);
      written[l] <= write[l];
      written_word[l] <= write_word[l];
    end
    product1 <= product;
    product2 <= product1;
    toggle <= !toggle;
  end

  // ---- Which half of the engine's clock it is: an edge of the engine's clock changes `toggle`, and
  // the next one of the other clock sees that.
  logic seen, second;
  always_ff @(posedge clock2) begin
    seen <= toggle;
    second <= toggle != seen;
  end

  wire [1:0][AddressBits-1:0] port_address;
  wire [1:0][Width-1:0] out;
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
  assign pass_word = out[Lanes-1:0];

endmodule

`default_nettype wire
