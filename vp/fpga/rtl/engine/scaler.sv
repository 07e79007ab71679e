// The power of two by which a vector is re-scaled whose entries are bounded by
// first * 2^first_exponent + mantissa * largest * 2^second_exponent: fixed::ReferenceMachine's
// rescaling() and fixed::sum_bit_length() (docs/fixed-point.md, dynamic scaling).
//
// One adder, one shifter and one multiplier, in 25 clocks from `start` to `done`; they follow the
// divider, and both together have to be through within the latency of a division.
`default_nettype none

module scaler #(
    parameter int FirstBits = 15,
    parameter int MantissaBits = 15,  // of a magnitude
    parameter int LargestBits = 31,
    parameter int ExponentBits = 22,
    parameter int WordBits = 16,      // of the vector that is written, sign included
    parameter int WideWordBits = 16   // the same where the input `wide` says so
) (
    input wire clock,
    input wire reset,
    input wire start,
    // These hold still until `done`.
    input wire wide,
    input wire [FirstBits-1:0] first,
    input wire signed [ExponentBits-1:0] first_exponent,
    input wire [MantissaBits-1:0] mantissa,
    input wire [LargestBits-1:0] largest,
    input wire signed [ExponentBits-1:0] second_exponent,
    input wire dynamic_scaling,
    input wire scaling_down,
    input wire [4:0] target,      // bits of magnitude after scaling up
    input wire [4:0] available,
    input wire [4:0] threshold,   // 1 to 16
    input wire [4:0] step,        // 1 to 16
    output logic done,
    output logic signed [ExponentBits-1:0] up
);

  localparam int E = ExponentBits;
  localparam int SecondBits = MantissaBits + LargestBits;
  localparam int W = SecondBits > 43 ? SecondBits : 43;  // the widened sum is measured here too
  localparam int Adder = 40;                             // bits to which both terms are cut
  localparam int Multiple = 8;                           // bits of what is divided by the step

  typedef enum logic [4:0] {
    Wait,
    MeasureFirst,
    Settle,
    MeasureSecond,
    SecondTop,
    Tops,
    Distances,
    CoarseFirst,
    AlignFirst,
    AlignSecond,
    Add,
    Widen,
    MeasureSum,
    Bits,
    Compare,
    Cut,
    Decide,
    Divide,
    Finish
  } state_t;
  state_t state;

  // The largest magnitude is multiplied in two parts, of which each fits a multiplier.
  localparam int Low = LargestBits > 18 ? 18 : LargestBits;
  localparam int High = LargestBits > Low ? LargestBits - Low : 1;
  logic [MantissaBits+Low-1:0] low_product;
  logic [MantissaBits+High-1:0] high_product;
  wire [High-1:0] high = High'(largest >> Low);
  logic [SecondBits-1:0] second;
  logic first_zero, second_zero;
  logic [Adder+2:0] widened;

  // The length of a magnitude: its highest byte that is not zero, and in it, a clock later, the highest
  // bit.
  logic [W-1:0] measured;
  logic [7:0] next_byte, top_byte;
  logic [2:0] next_index, top_index;
  logic [6:0] length;
  always_comb begin
    automatic logic [63:0] padded = 64'(measured);
    next_byte = '0;
    next_index = '0;
    for (int i = 0; i < 8; ++i) begin
      if (|padded[8*i+:8]) begin
        next_byte = padded[8*i+:8];
        next_index = 3'(i);
      end
    end
    length = '0;
    for (int i = 0; i < 8; ++i) if (top_byte[i]) length = {1'b0, top_index, 3'b000} + 7'(i + 1);
  end
  always_comb begin
    case (state)
      MeasureFirst: measured = W'(first);
      Settle: measured = W'(second);
      default: measured = W'(widened);
    endcase
  end

  // A term, cut to units of 2^unit: the whole part, and one more where bits may have been lost. It is
  // shifted by eights, and in the state behind that by ones; the one more is added later.
  logic signed [E-1:0] unit;
  logic [E-1:0] first_left, second_left, first_right, second_right;
  wire coarse_first = state == CoarseFirst;
  wire [W-1:0] term = coarse_first ? W'(first) : W'(second);
  wire [E-1:0] left = coarse_first ? first_left : second_left;
  wire [E-1:0] right = coarse_first ? first_right : second_right;
  logic [W-1:0] coarse;
  logic [2:0] ones;
  logic coarse_zero, coarse_left, coarse_gone;
  always_ff @(posedge clock) begin
    coarse <= left[E-1] ? term >> {right[5:3], 3'b000} : term << {left[5:3], 3'b000};
    ones <= left[E-1] ? right[2:0] : left[2:0];
    coarse_left <= !left[E-1];
    coarse_zero <= coarse_first ? first_zero : second_zero;
    coarse_gone <= left[E-1] && |right[E-1:6];
  end
  wire [Adder:0] shifted =
      coarse_gone ? '0 : (Adder + 1)'(coarse_left ? coarse << ones : coarse >> ones);
  wire [Adder:0] aligned = coarse_zero ? '0 : shifted;
  wire aligned_up = !coarse_zero && !coarse_left;

  logic signed [E-1:0] first_top, second_top, bits, unused, excess, excess_cut;
  // Lengths of the terms are counted from that of the adder, so that the higher top is the unit.
  logic signed [7:0] first_length, second_length;
  wire signed [7:0] length_beyond = $signed({1'b0, length}) - 8'(Adder);
  logic unused_enough, exceeds;
  logic [Adder:0] first_term, second_term;
  logic first_up, second_up;
  logic [Adder+1:0] sum;
  logic negative;

  // The largest multiple of the step in `dividend`, one bit of the quotient a clock.
  logic [Multiple-1:0] dividend;
  logic [Multiple-1:0] multiple;
  logic [4:0] rest;
  logic [2:0] count;
  wire [5:0] next_rest = {rest, dividend[Multiple-1]};
  wire takes = next_rest >= {1'b0, step};
  wire [5:0] kept_rest = takes ? next_rest - {1'b0, step} : next_rest;

  function automatic logic [Multiple-1:0] cut(input logic signed [E-1:0] value);
    return |value[E-1:Multiple] ? '1 : value[Multiple-1:0];
  endfunction

  always_ff @(posedge clock) begin
    done <= 1'b0;
    low_product <= mantissa * largest[Low-1:0];
    high_product <= mantissa * high;
    top_byte <= next_byte;
    top_index <= next_index;
    case (state)
      Wait:
      if (start) begin
        multiple <= '0;
        negative <= 1'b0;
        state <= dynamic_scaling ? MeasureFirst : Finish;
      end
      MeasureFirst: begin
        second <= SecondBits'(low_product) + (SecondBits'(high_product) << Low);
        state <= Settle;
      end
      Settle: begin
        first_length <= length_beyond;
        first_zero <= first == '0;
        second_zero <= second == '0;
        state <= MeasureSecond;
      end
      MeasureSecond: begin
        first_top <= E'(first_length) + first_exponent;
        second_length <= length_beyond;
        state <= SecondTop;
      end
      SecondTop: begin
        second_top <= E'(second_length) + second_exponent;
        state <= Tops;
      end
      Tops: begin
        unit <= second_zero || (!first_zero && first_top > second_top) ? first_top : second_top;
        state <= Distances;
      end
      Distances: begin
        first_left <= first_exponent - unit;
        first_right <= unit - first_exponent;
        second_left <= second_exponent - unit;
        second_right <= unit - second_exponent;
        state <= CoarseFirst;
      end
      CoarseFirst: state <= AlignFirst;
      AlignFirst: begin
        first_term <= aligned;
        first_up <= aligned_up;
        state <= AlignSecond;
      end
      AlignSecond: begin
        first_term <= first_term + (Adder + 1)'(first_up);
        second_term <= aligned;
        second_up <= aligned_up;
        state <= Add;
      end
      Add: begin
        sum <= {1'b0, first_term} + {1'b0, second_term} + (Adder + 2)'(second_up);
        state <= Widen;
      end
      Widen: begin  // room for the rounding of both terms
        widened <= {1'b0, sum} + (wide ? {1'b0, sum} >> (WideWordBits - 3)
                                       : {1'b0, sum} >> (WordBits - 3));
        state <= MeasureSum;
      end
      MeasureSum: state <= Bits;
      Bits: begin
        bits <= first_zero && second_zero ? '0 : E'(length) + unit;
        state <= Compare;
      end
      Compare: begin
        unused <= E'(target) - bits;
        excess <= bits - E'(available);
        state <= Cut;
      end
      Cut: begin
        unused_enough <= unused >= $signed(E'(threshold));
        exceeds <= excess > 0 && scaling_down;
        excess_cut <= excess + E'(step) - E'(1);
        state <= Decide;
      end
      Decide: begin
        rest <= '0;
        count <= 3'(Multiple - 1);
        state <= Divide;
        if (unused_enough) begin
          dividend <= cut(unused);
        end else if (exceeds) begin
          dividend <= cut(excess_cut);
          negative <= 1'b1;
        end else begin
          dividend <= '0;
        end
      end
      Divide: begin
        rest <= kept_rest[4:0];
        multiple <= (multiple << 1) + (takes ? Multiple'(step) : '0);
        dividend <= dividend << 1;
        count <= count - 1'b1;
        if (count == '0) state <= Finish;
      end
      Finish: begin
        up <= negative ? -E'(multiple) : E'(multiple);
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
  wire unused_bit = kept_rest[5];  // the rest is below the step

endmodule

`default_nettype wire
