// alpha and beta: numerator / denominator, rounded to a mantissa with a shift of its own, bit by bit
// as fixed::ratio does it. numerator >= 0, denominator > 0.
//
// Both are shifted to the top of their registers, by eights and then by ones, side by side; then
// each clock gives a bit of the quotient. With S-bit scalars and mantissas of C bits (the sign
// included) this takes 6 + (S - 1) / 8 + 7 + C clocks at most from `start` to `done`.
`default_nettype none

module coefficient_divider
  import engine_types::*;
#(
    parameter int ScalarBits = 64,
    parameter int CoefficientBits = 16,
    parameter int ExponentBits = 22
) (
    input wire clock,
    input wire reset,
    input wire rounding_t rounding,
    input wire start,
    input wire [ScalarBits-2:0] numerator,
    input wire [ScalarBits-2:0] denominator,
    output logic done,
    output logic [CoefficientBits-2:0] mantissa,
    output logic signed [ExponentBits-1:0] exponent
);

  localparam int W = ScalarBits - 1;
  localparam int Steps = CoefficientBits - 1;
  localparam int CountBits = $clog2(Steps);

  typedef enum logic [2:0] {
    Wait,
    Eights,
    Ones,
    Compare,
    Step,
    Round,
    Finish
  } state_t;

  state_t state;
  logic [W:0] rest;  // one bit more: it is doubled
  logic [W-1:0] divisor;
  logic [Steps-1:0] quotient;
  logic [CountBits-1:0] left;
  logic zero, nothing, less, up;  // the divisor is nothing by a flipped bit only

  wire signed [W+1:0] difference = $signed({1'b0, rest}) - $signed({2'b00, divisor});
  wire fits = !difference[W+1];
  wire numerator_by_eight = !zero && rest[W-1-:8] == '0;
  wire divisor_by_eight = !nothing && divisor[W-1-:8] == '0;
  wire numerator_by_one = !zero && !rest[W-1];
  wire divisor_by_one = !nothing && !divisor[W-1];
  wire [Steps:0] rounded = {1'b0, quotient} + (Steps + 1)'(up);

  always_ff @(posedge clock) begin
    done <= 1'b0;
    case (state)
      Wait:
      if (start) begin
        rest <= {1'b0, numerator};
        divisor <= denominator;
        zero <= numerator == '0;
        nothing <= denominator == '0;
        exponent <= '0;
        state <= Eights;
      end
      Eights: begin
        if (numerator_by_eight) rest <= rest << 8;
        if (divisor_by_eight) divisor <= divisor << 8;
        if (divisor_by_eight && !numerator_by_eight) exponent <= exponent + ExponentBits'(8);
        if (numerator_by_eight && !divisor_by_eight) exponent <= exponent - ExponentBits'(8);
        if (!numerator_by_eight && !divisor_by_eight) state <= Ones;
      end
      Ones: begin
        if (numerator_by_one) rest <= rest << 1;
        if (divisor_by_one) divisor <= divisor << 1;
        if (divisor_by_one && !numerator_by_one) exponent <= exponent + ExponentBits'(1);
        if (numerator_by_one && !divisor_by_one) exponent <= exponent - ExponentBits'(1);
        if (!numerator_by_one && !divisor_by_one) state <= Compare;
      end
      Compare: begin  // to 1 <= rest / divisor < 2
        if (!fits) rest <= rest << 1;
        less <= !fits;
        left <= CountBits'(Steps - 1);
        state <= Step;
      end
      Step: begin
        quotient <= {quotient[Steps-2:0], fits};
        rest <= (fits ? difference[W:0] : rest) << 1;
        left <= left - 1'b1;
        if (left == '0) state <= Round;
      end
      Round: begin  // `rest` is twice the remainder
        case (rounding)
          NearestEven: up <= fits && (difference != '0 || quotient[0]);
          NearestUp: up <= fits;
          default: up <= 1'b0;
        endcase
        exponent <= exponent - ExponentBits'(Steps - 1) - ExponentBits'(less);
        state <= Finish;
      end
      Finish: begin  // a carry out of the mantissa leaves one bit of it
        mantissa <= zero ? '0 : rounded[Steps] ? {1'b1, {(Steps - 1) {1'b0}}} : rounded[Steps-1:0];
        exponent <= zero ? '0 : exponent + ExponentBits'(rounded[Steps]);
        done <= 1'b1;
        state <= Wait;
      end
      default: state <= Wait;
    endcase
    if (reset) begin
      state <= Wait;
      done <= 1'b0;
    end
  end

endmodule

`default_nettype wire
