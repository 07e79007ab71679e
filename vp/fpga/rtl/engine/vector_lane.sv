// One component of a lane of the vector unit: what engine::VectorUnit does to a node's
// words, in sign and magnitude up to the sums (thesis Fig. 5.10).
//
// Ranks are counted in edges from the one at which a group enters:
//   2 the words arrive     3 magnitudes, b - q      4, 5 multipliers    6 one magnitude a term
//   7 to 9 aligned         10 added                 11 clamped          12 to 14 r * r; to 15 with a preconditioner
// Rows of a product enter at rank 2 with q and the word of d at their own node; |b - q| is there at
// rank 4, b * b at rank 5 or 6, and q * d at rank 6.
`default_nettype none

module vector_lane
  import engine_types::*;
#(
    parameter int VectorBits = 16,
    parameter int ResidualBits = 16,   // of r, z and b; VectorBits without a preconditioner
    parameter int DirectionBits = 16,  // of z where it becomes d (engine_types.sv)
    parameter int ProductBits = 32,
    parameter int CoefficientBits = 16,
    parameter int StaticBits = 4,      // of the static shift
    parameter int ProductShift = 0,    // bits that q has dropped
    localparam int DifferenceBits =
        difference_bits(VectorBits, StaticBits, ProductBits, ProductShift)
) (
    input wire clock,
    // Still while a pass runs.
    input wire pass_t pass,
    input wire exchange,
    input wire alone,                  // guess: no solution lies before x
    input wire rounding_t rounding,
    input wire [StaticBits-1:0] static_shift,
    input wire [CoefficientBits-2:0] coefficient,
    input wire wide,                   // r, z and b have ResidualBits, not VectorBits
    // The shifts to the right, and whether they would be too far to the left: of coefficient * d,
    // of coefficient * q or b - q, and of r. The aligner's words have these places behind the point:
    // `BelowD`, `BelowQ` or `BelowDifference`, and ResidualBits - 1.
    input wire [6:0] right_d,
    input wire [6:0] right_q,
    input wire [6:0] right_r,
    input wire beyond_d,
    input wire beyond_q,
    input wire beyond_r,
    // Rank 2.
    input wire signed [VectorBits-1:0] x,
    input wire signed [VectorBits-1:0] previous,
    input wire signed [VectorBits-1:0] d,
    input wire signed [ResidualBits-1:0] r,  // z in the passes that make d
    input wire signed [ResidualBits-1:0] b,
    input wire signed [ProductBits-1:0] q,
    // Rank 3: b was the one word that has no negative.
    output logic b_clamped,
    // Rank 4.
    output logic [DifferenceBits-1:0] difference,
    // Rank 6.
    output logic signed [ProductBits+VectorBits-1:0] q_d,
    // Rank 11.
    output logic signed [VectorBits-1:0] sum_word,  // x, d or the guess
    output logic signed [ResidualBits-1:0] r_word,
    output logic signed [VectorBits-1:0] old_d,
    output logic sum_clamped,
    output logic r_clamped,
    // Of r; of a row's b nine ranks before.
    output wire [2*ResidualBits-3:0] square
);

  /* verilator no_inline_module */
  // One copy of the code for all lanes, so that it stays in the simulating processor's cache.

  localparam int V = VectorBits;
  localparam int Q = ProductBits;
  localparam int C = CoefficientBits;
  localparam int R = ResidualBits;
  localparam int BelowD = below_products(DirectionBits, C);
  localparam int BelowQ = below_products(R, C);
  localparam int BelowDifference = R - 2;
  localparam int FactorBits = V > C ? V - 1 : C - 1;
  localparam int LowBits = Q / 2;
  localparam int ScaledBits = Q - 1 + FactorBits;
  localparam int ProductWidth = ScaledBits + BelowQ;
  localparam int DifferenceWidth = DifferenceBits + BelowDifference;
  localparam int TermBits = ProductWidth > DifferenceWidth ? ProductWidth : DifferenceWidth;
  localparam int OutBits = DirectionBits + 2;
  localparam int W = OutBits + 2;  // of a sum
  localparam logic signed [V-1:0] Limit = {1'b0, {(V - 1) {1'b1}}};
  localparam logic signed [R-1:0] WideLimit = {1'b0, {(R - 1) {1'b1}}};
  wire signed [R-1:0] r_limit = wide ? WideLimit : R'(Limit);

  wire is_product = pass == Product;
  wire is_residual = pass == Residual;
  wire adds_x = pass == Update || pass == Guess || pass == Copy || pass == Residual;
  wire adds_d = pass == Update || pass == Direction;
  wire clamps = pass != Copy && pass != Residual;

  // Rank 3.
  logic [V-2:0] size_d3;
  logic [R-2:0] size_r3;
  logic [Q-2:0] size_q3;
  logic [FactorBits-1:0] factor3;
  logic d_negative3, r_negative3, q_negative3;
  logic signed [DifferenceBits:0] full3;
  logic signed [V+1:0] base3;
  wire no_negative = b == ~r_limit;
  wire signed [R-1:0] b_word = no_negative ? -r_limit : b;
  wire signed [DifferenceBits:0] b_scaled = (DifferenceBits + 1)'(b_word) <<< static_shift;
  wire signed [DifferenceBits:0] q_scaled = (DifferenceBits + 1)'(q) <<< ProductShift;
  wire on_line = pass == Guess && !alone;
  wire [V-1:0] d_size = d[V-1] ? -d : d;
  wire [R-1:0] r_size = r[R-1] ? -r : r;
  wire [Q-1:0] q_size = q[Q-1] ? -q : q;
  always_ff @(posedge clock) begin
    size_d3 <= d_size[V-2:0];
    size_r3 <= wide ? r_size[R-2:0] : (R - 1)'(r_size[V-2:0]);
    size_q3 <= q_size[Q-2:0];
    factor3 <= is_product ? FactorBits'(d_size[V-2:0]) : FactorBits'(coefficient);
    d_negative3 <= d[V-1];
    r_negative3 <= r[R-1];
    q_negative3 <= q[Q-1] ^ (is_product && d[V-1]);
    full3 <= b_scaled - q_scaled;
    base3 <= on_line ? ((V + 2)'(x) <<< 1) - (V + 2)'(previous) : (V + 2)'(x);
    b_clamped <= no_negative;
  end

  // Ranks 4 and 5: the products, that of q in halves.
  logic [V+C-3:0] d_product4, d_product5;
  logic [LowBits+FactorBits-1:0] low4, low5;
  logic [Q-2-LowBits+FactorBits:0] high4, high5;
  logic [DifferenceBits-1:0] difference5;
  logic full_negative4, full_negative5, d_negative4, d_negative5, q_negative4, q_negative5;
  wire [DifferenceBits:0] full_size = full3[DifferenceBits] ? -full3 : full3;
  always_ff @(posedge clock) begin
    d_product4 <= size_d3 * coefficient;
    d_product5 <= d_product4;
    low4 <= size_q3[LowBits-1:0] * factor3;
    low5 <= low4;
    high4 <= size_q3[Q-2:LowBits] * factor3;
    high5 <= high4;
    difference <= full_size[DifferenceBits-1:0];
    difference5 <= difference;
    full_negative4 <= full3[DifferenceBits];
    full_negative5 <= full_negative4;
    d_negative4 <= d_negative3;
    d_negative5 <= d_negative4;
    q_negative4 <= q_negative3;
    q_negative5 <= q_negative4;
  end

  // Rank 6: one magnitude a term, with its places behind the point.
  logic [V+C-3+BelowD:0] d_term6;
  logic [TermBits-1:0] q_term6;
  logic d_negative6, q_negative6;
  wire [ScaledBits-1:0] q_product = {high5, {LowBits{1'b0}}} + ScaledBits'(low5);
  // Only the product of q and d is summed as a signed number, and |d| has V - 1 bits.
  wire [Q+V-1:0] q_d_size = (Q + V)'(q_product);
  always_ff @(posedge clock) begin
    d_term6 <= {d_product5, {BelowD{1'b0}}};
    q_term6 <= is_residual ? TermBits'({difference5, {BelowDifference{1'b0}}})
                           : TermBits'({q_product, {BelowQ{1'b0}}});
    d_negative6 <= d_negative5;
    q_negative6 <= is_residual ? full_negative5 : q_negative5;
    q_d <= q_negative5 ? -q_d_size : q_d_size;
  end

  // What waits beside the multipliers: x or the guess up to rank 9, r up to rank 6, d up to 11.
  logic signed [V+1:0] base[4:9];
  logic [R-2:0] r_size_late[4:6];
  logic [9:4] r_negative;
  logic signed [V-1:0] d_late[3:10];
  always_ff @(posedge clock) begin
    base[4] <= base3;
    for (int i = 5; i <= 9; ++i) base[i] <= base[i-1];
    r_size_late[4] <= size_r3;
    for (int i = 5; i <= 6; ++i) r_size_late[i] <= r_size_late[i-1];
    r_negative <= {r_negative[8:4], r_negative3};
    if (exchange) begin
      d_late[3] <= d;
      for (int i = 4; i <= 10; ++i) d_late[i] <= d_late[i-1];
      old_d <= d_late[10];
    end
  end

  // Ranks 7 to 9.
  wire [OutBits-1:0] aligned_d, aligned_q, aligned_r;
  rounding_shift #(
      .InBits(V + C - 2 + BelowD),
      .OutBits(OutBits),
      .RightBits(7)
  ) align_d (
      .clock,
      .rounding,
      .right(right_d),
      .beyond(beyond_d),
      .magnitude(d_term6),
      .word(aligned_d)
  );
  rounding_shift #(
      .InBits(TermBits),
      .OutBits(OutBits),
      .RightBits(7)
  ) align_q (
      .clock,
      .rounding,
      .right(right_q),
      .beyond(beyond_q),
      .magnitude(q_term6),
      .word(aligned_q)
  );
  rounding_shift #(
      .InBits(2 * R - 2),
      .OutBits(OutBits),
      .RightBits(7)
  ) align_r (
      .clock,
      .rounding,
      .right(right_r),
      .beyond(beyond_r),
      .magnitude({r_size_late[6], {(R - 1) {1'b0}}}),
      .word(aligned_r)
  );
  logic [9:7] d_negative, q_negative;
  always_ff @(posedge clock) begin
    d_negative <= {d_negative[8:7], d_negative6};
    q_negative <= {q_negative[8:7], q_negative6};
  end

  // Ranks 10 and 11.
  function automatic logic signed [W-1:0] signed_of(input logic negative,
                                                    input logic [OutBits-1:0] size);
    return negative ? -W'(size) : W'(size);
  endfunction
  wire signed [W-1:0] d_part = signed_of(d_negative[9], aligned_d);
  wire signed [W-1:0] q_part = signed_of(q_negative[9], aligned_q);
  wire signed [W-1:0] r_part = signed_of(r_negative[9], aligned_r);
  logic signed [W-1:0] sum10, r10;
  wire sum_above = sum10 > W'(Limit);
  wire sum_below = sum10 < -W'(Limit);
  wire r_above = r10 > W'(r_limit);
  wire r_below = r10 < -W'(r_limit);
  always_ff @(posedge clock) begin
    sum10 <= (adds_x ? W'(base[9]) : r_part) + (adds_d ? d_part : '0);
    r10 <= is_residual ? q_part : r_part - q_part;
    sum_word <= !clamps ? sum10[V-1:0] : sum_above ? Limit : sum_below ? -Limit : sum10[V-1:0];
    sum_clamped <= clamps && (sum_above || sum_below);
    r_word <= r_above ? r_limit : r_below ? -r_limit : r10[R-1:0];
    r_clamped <= r_above || r_below;
  end

  // From rank 12 on; a row's b is multiplied from rank 3 on.
  logic [R-2:0] r_factor;
  wire [R-1:0] r_word_size = r_word[R-1] ? -r_word : r_word;
  wire [R-1:0] b_size = b_word[R-1] ? -b_word : b_word;
  always_ff @(posedge clock) begin
    r_factor <= is_product ? b_size[R-2:0] : r_word_size[R-2:0];
  end
  if (R > V) begin : g_wide_square
    wide_multiplier #(
        .Bits(R - 1)
    ) squared (
        .clock,
        .a(r_factor),
        .b(r_factor),
        .product(square)
    );
  end else begin : g_square
    logic [2*R-3:0] square13, square14;
    always_ff @(posedge clock) begin
      square13 <= r_factor * r_factor;
      square14 <= square13;
    end
    assign square = square14;
  end

  wire unused = &{1'b0, d_size[V-1], r_size[R-1], q_size[Q-1], r_word_size[R-1], b_size[R-1],
                  full_size[DifferenceBits]};

endmodule

`default_nettype wire
