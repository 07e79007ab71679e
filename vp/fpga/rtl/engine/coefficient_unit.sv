// alpha and beta with their exponents, and the power of two by which r or d is re-scaled as it
// changes (engine::Sequencer::take_quotient, form_update and form_direction): the divider, and behind
// it the scaler.
//
// Both work within the latency of a division, whose clocks the sequencer counts: `over` is its end.
`default_nettype none

module coefficient_unit
  import engine_types::*;
#(
    parameter int VectorBits = 16,
    parameter int ResidualBits = 16,  // of r and z where the engine has a preconditioner
    parameter int ProductBits = 32,
    parameter int CoefficientBits = 16,
    parameter int ScalarBits = 64,
    parameter int ExponentBits = 22,
    parameter int ProductShift = 0
) (
    input wire clock,
    input wire reset,
    input wire rounding_t division_rounding,
    input wire dynamic_scaling,
    input wire scaling_down,
    input wire wide,  // r and z have ResidualBits
    input wire [4:0] target,
    input wire [4:0] threshold,
    input wire [4:0] step,
    // What follows `divides` holds still until the division is over.
    input wire divides,
    input wire in_alpha,
    input wire holds,        // nobody takes the quotient
    input wire clears_beta,
    input wire over,
    input wire [ScalarBits-2:0] numerator,
    input wire [ScalarBits-2:0] denominator,
    input wire signed [ExponentBits-1:0] scalar_exponent,         // of z.r
    input wire signed [ExponentBits-1:0] scalar_exponent_before,
    input wire signed [ExponentBits-1:0] r_exponent,
    input wire signed [ExponentBits-1:0] z_exponent,
    input wire signed [ExponentBits-1:0] d_exponent,
    input wire [ResidualBits-2:0] largest_r,
    input wire [ResidualBits-2:0] largest_z,
    input wire [VectorBits-2:0] largest_d,
    input wire [ProductBits-2:0] largest_q,
    output logic [CoefficientBits-2:0] alpha,
    output logic signed [ExponentBits-1:0] alpha_exponent,
    output logic signed [ExponentBits-1:0] change_exponent,  // of alpha * q, in units of r
    output logic [CoefficientBits-2:0] beta,
    output logic signed [ExponentBits-1:0] beta_exponent,
    output wire signed [ExponentBits-1:0] up
);

  localparam int V = VectorBits;
  localparam int C = CoefficientBits;
  localparam int E = ExponentBits;
  wire signed [E-1:0] q_exponent = d_exponent - E'(ProductShift);

  wire divided, scaled;
  wire [C-2:0] mantissa;
  wire signed [E-1:0] quotient_exponent;
  coefficient_divider #(
      .ScalarBits(ScalarBits),
      .CoefficientBits(C),
      .ExponentBits(E)
  ) divider (
      .clock,
      .reset,
      .rounding(division_rounding),
      .start(divides),
      .numerator,
      .denominator,
      .done(divided),
      .mantissa,
      .exponent(quotient_exponent)
  );

  // The exponents of a division are taken at its start, like its other operands.
  logic signed [E-1:0] first_exponent, quotient_unit, change_unit;
  always_ff @(posedge clock) begin
    if (divides) begin
      first_exponent <= in_alpha ? '0 : d_exponent - z_exponent;
      quotient_unit <= in_alpha ? d_exponent + q_exponent - scalar_exponent
                                : scalar_exponent_before - scalar_exponent;
      change_unit <= d_exponent - scalar_exponent + r_exponent;
    end
  end

  logic scales;
  always_ff @(posedge clock) begin
    scales <= divided && !holds && !reset;
    if (divided && !holds) begin
      if (in_alpha) begin
        alpha <= mantissa;
        alpha_exponent <= quotient_exponent + quotient_unit;
        change_exponent <= quotient_exponent + change_unit;
      end else begin
        beta <= mantissa;
        beta_exponent <= quotient_exponent + quotient_unit;
      end
    end
    if (clears_beta) begin
      beta <= '0;
      beta_exponent <= '0;
    end
  end

  scaler #(
      .FirstBits(ResidualBits - 1),
      .MantissaBits(C - 1),
      .LargestBits(ProductBits - 1),
      .ExponentBits(E),
      .WordBits(V),
      .WideWordBits(ResidualBits)
  ) scaling (
      .clock,
      .reset,
      .start(scales),
      .wide(wide && in_alpha),
      .first(in_alpha ? largest_r : largest_z),
      .first_exponent,
      .mantissa(in_alpha ? alpha : beta),
      .largest(in_alpha ? largest_q : (ProductBits - 1)'(largest_d)),
      .second_exponent(in_alpha ? change_exponent : beta_exponent),
      .dynamic_scaling,
      .scaling_down,
      .target(wide && in_alpha ? 5'(WideTarget) : target),
      .available(wide && in_alpha ? 5'(WideTarget) : 5'(V - 1)),
      .threshold,
      .step,
      .done(scaled),
      .up
  );

`ifndef SYNTHESIS
  // Both have to be through within the latency of a division.
  logic late;
  always_ff @(posedge clock) begin
    if (divides) late <= !holds;
    else if (scaled || reset) late <= 1'b0;
    if (over && !reset && late) $error("a division and its scaling are not over");
  end
`else
  wire unused = &{1'b0, over, scaled};
`endif

endmodule

`default_nettype wire
