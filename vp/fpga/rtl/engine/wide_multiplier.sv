// The product of two magnitudes that are longer than a multiplier's inputs, three clocks later: four
// multipliers with a register behind each, and their sum.
`default_nettype none

module wide_multiplier #(
    parameter int Bits = 31
) (
    input wire clock,
    input wire [Bits-1:0] a,
    input wire [Bits-1:0] b,
    output logic [2*Bits-1:0] product
);

  localparam int Low = (Bits + 1) / 2;
  localparam int High = Bits - Low;

  logic [2*Low-1:0] low, low_late;
  logic [Bits-1:0] cross_a, cross_b, cross_a_late, cross_b_late;
  logic [2*High-1:0] high, high_late;
  wire [Bits:0] middle = {1'b0, cross_a_late} + {1'b0, cross_b_late};
  always_ff @(posedge clock) begin
    low <= a[Low-1:0] * b[Low-1:0];
    cross_a <= a[Bits-1:Low] * b[Low-1:0];
    cross_b <= a[Low-1:0] * b[Bits-1:Low];
    high <= a[Bits-1:Low] * b[Bits-1:Low];
    low_late <= low;
    cross_a_late <= cross_a;
    cross_b_late <= cross_b;
    high_late <= high;
    product <= {high_late, low_late} + ((2 * Bits)'(middle) << Low);
  end

endmodule

`default_nettype wire
