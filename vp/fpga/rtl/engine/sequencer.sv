// The control unit: the passes of a solve in the order of thesis Fig. 4.4, the exponents
// of the vectors (dynamic scaling, thesis section 4.2), alpha and beta (engine::Sequencer).
//
// It acts at the clock in which a unit says that it is done: the next unit begins with the clock
// after. A division takes DivisionClocks from the clock in which its operands are there to the one
// in which the next pass is ordered: the divider and then the scaler work fits_scalar them. Of a pass that
// makes z, z.r and its size may be LateSums clocks behind its end; they work that much later.
`default_nettype none

module sequencer
  import engine_types::*;
#(
    parameter int Preconditioner = 0,  // of Jacobi, of blocks
    parameter int MatrixBits = 12,
    parameter int VectorBits = 16,
    parameter int ResidualBits = 16,
    parameter int DirectionBits = 16,
    parameter int ProductBits = 32,
    parameter int CoefficientBits = 16,
    parameter int ScalarBits = 64,
    parameter int ExponentBits = 22,
    parameter int DifferenceBits = 32,
    parameter int DotBits = 60,
    parameter int SquareBits = 60,
    parameter int ProductShift = 0,
    parameter int DivisionClocks = 68,
    parameter int LateSums = 0
) (
    input wire clock,
    input wire reset,
    // Orders, while idle: a solve with x in the copies of d, or a copy of x into them.
    input wire go,
    input wire copy,
    input wire has_previous,  // an extrapolated start has a solution before x
    // The settings of the solve.
    input wire [15:0] iterations,
    input wire [15:0] replace_every,  // 0: never
    input wire starts_zero,
    input wire extrapolated,
    input wire dynamic_scaling,
    input wire scaling_down,
    input wire preconditions,
    input wire [5:0] inverse_shift,  // that z = P^-1 r drops
    input wire rounding_t division_rounding,
    input wire [4:0] static_shift,
    input wire [4:0] target,  // bits of magnitude after scaling up
    input wire [4:0] threshold,
    input wire [4:0] step,
    input wire stops,                        // the stop test may end the solve
    input wire [52:0] tolerance,             // of its square
    input wire signed [11:0] tolerance_exponent,
    // To the vector unit.
    output logic start,
    output pass_t pass,
    output logic hold,
    output logic compare,
    output logic first,
    output logic zero,
    output logic alone,
    output logic exchange,
    output logic [CoefficientBits-2:0] coefficient,
    output wire [6:0] right_d,
    output wire [6:0] right_q,
    output wire [6:0] right_r,
    output wire beyond_d,
    output wire beyond_q,
    output wire beyond_r,
    // From it.
    input wire done,
    input wire signed [DotBits-1:0] dot,
    input wire [SquareBits-1:0] squares,
    input wire signed [SquareBits:0] z_dot_r,
    input wire [ResidualBits-2:0] largest_r,
    input wire [ResidualBits-2:0] largest_z,
    input wire [VectorBits-2:0] largest_d,
    input wire [ProductBits-2:0] largest_q,
    input wire [DifferenceBits-1:0] widest,
    // The state, and what a solve has come to.
    output state_t state,
    output logic finished,        // for a clock, behind the last one
    output logic iteration_made,  // likewise, after each iteration whose words were written
    output logic breakdown,
    output logic reached,         // the stop test has ended it
    output logic scalar_overflow,
    output logic [15:0] made,
    output logic [15:0] replacements,
    // Registers that an iteration can be told by.
    output wire [CoefficientBits-2:0] alpha,
    output wire signed [ExponentBits-1:0] alpha_exponent,
    output wire signed [ExponentBits-1:0] change_exponent,  // of alpha * q, in units of r
    output wire [CoefficientBits-2:0] beta,
    output wire signed [ExponentBits-1:0] beta_exponent,
    output logic signed [ExponentBits-1:0] r_exponent,
    output logic signed [ExponentBits-1:0] d_exponent,
    output wire signed [ExponentBits-1:0] z_exponent,
    output logic signed [ScalarBits-1:0] z_r,
    output logic signed [ScalarBits-1:0] d_q
);

  localparam int V = VectorBits;
  localparam int R = ResidualBits;
  localparam int C = CoefficientBits;
  localparam int E = ExponentBits;
  localparam int S = ScalarBits;
  // Places behind the point of the aligners' words in vector_lane.sv.
  localparam int BelowD = below_products(DirectionBits, C);
  localparam int BelowQ = below_products(R, C);
  localparam int BelowDifference = R - 2;
  localparam int BelowR = R - 1;
  localparam int CountBits = $clog2(DivisionClocks + 1);

  logic [15:0] loops, until_replacement;
  logic replaced;
  logic signed [E-1:0] scalar_exponent, scalar_exponent_before;  // of z.r

  // ---- Inner products become scalars once.
  logic signed [S-1:0] scalar;
  logic overflows;
  if (DotBits > S) begin : g_clamped
    localparam logic signed [S-1:0] Limit = {1'b0, {(S - 1) {1'b1}}};
    wire above = dot > DotBits'(Limit);
    wire below = dot < -DotBits'(Limit);
    assign overflows = above || below;
    assign scalar = above ? Limit : below ? -Limit : dot[S-1:0];
  end else begin : g_exact
    assign overflows = 1'b0;
    assign scalar = S'(dot);
  end
  // The inverse diagonal has no negative words, so that z.r is negative with blocks alone: rounded, one
  // that is nearly singular need not be positive definite.
  logic signed [S-1:0] new_z_r;
  wire z_r_overflows;
  if (SquareBits > S - 1) begin : g_clamped_z_r
    localparam logic signed [S-1:0] Limit = {1'b0, {(S - 1) {1'b1}}};
    wire z_r_negative = z_dot_r[SquareBits];
    wire fits_scalar = z_r_negative ? &z_dot_r[SquareBits-1:S-1] && |z_dot_r[S-2:0]
                               : ~|z_dot_r[SquareBits-1:S-1];
    assign z_r_overflows = !fits_scalar;
    assign new_z_r = fits_scalar ? z_dot_r[S-1:0] : z_r_negative ? -Limit : Limit;
  end else begin : g_exact_z_r
    assign z_r_overflows = 1'b0;
    assign new_z_r = S'(z_dot_r);
  end
  wire no_z_r = new_z_r <= 0;

  // ---- Shifts of a pass. What is shifted to the right by more than 127 bits is zero.
  logic signed [E-1:0] d_shift, q_shift, r_shift;
  function automatic logic [6:0] count(input logic signed [E-1:0] right);
    return right[E-1] ? 7'd0 : |right[E-2:7] ? 7'd127 : right[6:0];
  endfunction
  assign right_d = count(d_shift);
  assign right_q = count(q_shift);
  assign right_r = count(r_shift);
  assign beyond_d = d_shift[E-1];
  assign beyond_q = q_shift[E-1];
  assign beyond_r = r_shift[E-1];

  function automatic logic signed [E-1:0] length(input logic [DifferenceBits-1:0] value);
    length = '0;
    for (int i = 0; i < DifferenceBits; ++i) if (value[i]) length = E'(i + 1);
  endfunction

  // ---- alpha and beta, and the shift of the vector that each changes.
  logic divides;
  logic holds_division;  // it works, and nobody takes its quotient
  logic clears_beta;     // there is no residual, so that no direction of old counts
  logic [CountBits-1:0] clocks_left;
  wire division_over = clocks_left == CountBits'(1);
  logic [S-2:0] numerator, denominator;
  wire signed [E-1:0] up;
  coefficient_unit #(
      .VectorBits(V),
      .ResidualBits(R),
      .ProductBits(ProductBits),
      .CoefficientBits(C),
      .ScalarBits(S),
      .ExponentBits(E),
      .ProductShift(ProductShift)
  ) coefficients (
      .clock,
      .reset,
      .division_rounding,
      .dynamic_scaling,
      .scaling_down,
      .wide(Preconditioner != 0 && preconditions),
      .target,
      .threshold,
      .step,
      .divides,
      .in_alpha(state == InAlpha),
      .holds(holds_division),
      .clears_beta,
      .over(division_over),
      .numerator,
      .denominator,
      .scalar_exponent,
      .scalar_exponent_before,
      .r_exponent,
      .z_exponent,
      .d_exponent,
      .largest_r,
      .largest_z,
      .largest_d,
      .largest_q,
      .alpha,
      .alpha_exponent,
      .change_exponent,
      .beta,
      .beta_exponent,
      .up
  );

  // ---- Exponents that follow from a pass' end.
  if (Preconditioner != 0) begin : g_z
    localparam logic signed [E-1:0] Scale = E'(MatrixBits + InverseBits);
    assign z_exponent = preconditions ? r_exponent + Scale - E'(inverse_shift) : r_exponent;
  end else begin : g_z_is_r
    assign z_exponent = r_exponent;
    wire unused = &{1'b0, preconditions, inverse_shift};
  end
  wire [4:0] residual_target = Preconditioner != 0 && preconditions ? 5'(WideTarget) : target;
  wire signed [E-1:0] difference_up = E'(residual_target) - length(widest);
  wire signed [E-1:0] residual_exponent =
      dynamic_scaling && widest != '0 ? difference_up : -E'(static_shift);
  // The first d is in units of x where nothing scales z.
  wire signed [E-1:0] first_up =
      dynamic_scaling ? E'(target) - length(DifferenceBits'(largest_z))
                      : Preconditioner != 0 && preconditions ? -z_exponent : '0;
  // Only used where a replacement does not take the place of the scaling.
  wire signed [E-1:0] r_up = replaced ? '0 : up;
  wire signed [E-1:0] d_up = holds_division ? '0 : up;

  // ---- The stop test, beside what follows.
  wire small_enough;
  wire forms_r = state == InStartResidual || state == InAnewResidual ||
                 (state == InUpdate && !replaced);
  stop_test #(
      .SquareBits(SquareBits),
      .ExponentBits(E)
  ) stopping (
      .clock,
      .reset,
      .tolerance,
      .tolerance_exponent,
      .static_shift,
      .take_rhs(done && state == InStartProduct),
      .rhs_squares(squares),
      .take_residual(done && forms_r && !hold),
      .squares,
      .r_exponent,
      .reached(small_enough)
  );

  // ---- The sums of a pass that has made r are there.
  wire sums_made;
  if (LateSums == 0) begin : g_in_time
    assign sums_made = done && forms_r;
  end else begin : g_late
    logic [LateSums-1:0] late;
    always_ff @(posedge clock) late <= reset ? '0 : LateSums'({late, done && forms_r});
    assign sums_made = preconditions ? late[LateSums-1] : done && forms_r;
  end
  // Behind the start's residual stands the first direction, which may have begun: its d waits for
  // the shift up to rank 6.
  logic starting;
  wire takes_first =
      LateSums == 0 || !preconditions ? state == InStartResidual : starting;

  wire [15:0] loops_now = state == InDirection ? loops + 1'b1 : loops;

  always_ff @(posedge clock) begin
    start <= 1'b0;
    divides <= 1'b0;
    clears_beta <= 1'b0;
    finished <= 1'b0;
    iteration_made <= 1'b0;
    if (clocks_left != '0) clocks_left <= clocks_left - 1'b1;

    case (state)
      InIdle: begin
        hold <= 1'b0;
        exchange <= 1'b0;
        compare <= 1'b1;
        first <= 1'b1;
        zero <= starts_zero && go;
        alone <= !has_previous;
        loops <= '0;
        until_replacement <= replace_every;
        replaced <= 1'b0;
        if (go) begin
          made <= '0;
          replacements <= '0;
          breakdown <= 1'b0;
          reached <= 1'b0;
          scalar_overflow <= 1'b0;
          start <= 1'b1;
          pass <= extrapolated ? Guess : Product;
          state <= extrapolated ? InGuess : InStartProduct;
        end else if (copy) begin
          start <= 1'b1;
          pass <= Copy;
          state <= InCopy;
        end
      end

      InCopy: if (done) state <= InIdle;

      InGuess:
      if (done) begin
        start <= 1'b1;
        pass <= Product;
        state <= InStartProduct;
      end

      InStartProduct, InAnewProduct:
      if (done) begin
        start <= 1'b1;
        pass <= Residual;
        compare <= 1'b0;
        exchange <= state == InAnewProduct;
        r_exponent <= residual_exponent;
        q_shift <= E'(BelowDifference) - residual_exponent;
        state <= state == InAnewProduct ? InAnewResidual : InStartResidual;
      end

      InStartResidual:
      if (done) begin
        start <= 1'b1;
        pass <= FirstDirection;
        first <= 1'b0;
        zero <= 1'b0;
        starting <= 1'b1;
        state <= InFirstDirection;
      end

      InFirstDirection, InDirection:
      if (done) begin
        loops <= loops_now;
        iteration_made <= state == InDirection && !hold;
        if (loops_now == iterations) begin
          finished <= 1'b1;
          state <= InIdle;
        end else if (stops && !hold && small_enough) begin
          reached <= 1'b1;
          finished <= 1'b1;
          state <= InIdle;
        end else begin
          if (z_r <= 0 || largest_d == '0) hold <= 1'b1;
          start <= 1'b1;
          pass <= Product;
          state <= InProduct;
        end
      end

      InProduct:
      if (done) begin
        holds_division <= hold;
        if (!hold) begin
          d_q <= scalar;
          scalar_overflow <= scalar_overflow || overflows;
        end
        if (!hold && scalar <= 0) begin
          breakdown <= 1'b1;
          finished <= 1'b1;
          state <= InIdle;
        end else begin
          divides <= 1'b1;
          numerator <= z_r[S-2:0];
          denominator <= hold ? (S - 1)'(1) : scalar[S-2:0];
          clocks_left <= CountBits'(DivisionClocks);
          // A residual is formed anew in this iteration.
          replaced <= !hold && until_replacement == 16'd1;
          state <= InAlpha;
        end
      end

      InAlpha:
      if (division_over) begin
        start <= 1'b1;
        pass <= Update;
        exchange <= replaced;
        coefficient <= alpha;
        if (!hold) begin
          made <= made + 1'b1;
          if (replaced) replacements <= replacements + 1'b1;
          if (replace_every != '0) begin
            until_replacement <= replaced ? replace_every : until_replacement - 1'b1;
          end
          r_exponent <= r_exponent + r_up;
          d_shift <= E'(BelowD) - (alpha_exponent - d_exponent);
          q_shift <= E'(BelowQ) - (change_exponent + r_up);
          r_shift <= E'(BelowR) - r_up;
        end
        state <= InUpdate;
      end

      InUpdate:
      if (done && replaced) begin
        start <= 1'b1;
        pass <= Product;
        compare <= 1'b1;
        exchange <= 1'b0;
        state <= InAnewProduct;
      end else if (done) begin
        clocks_left <= CountBits'(DivisionClocks);
        state <= InBeta;
      end

      InAnewResidual:
      if (done) begin
        exchange <= 1'b0;
        replaced <= 1'b0;
        clocks_left <= CountBits'(DivisionClocks);
        state <= InBeta;
      end

      InBeta:
      if (division_over) begin
        start <= 1'b1;
        pass <= Direction;
        coefficient <= beta;
        if (!hold) begin
          d_exponent <= d_exponent + d_up;
          d_shift <= E'(BelowD) - (beta_exponent + d_up);
          r_shift <= E'(BelowR) - (d_exponent + d_up - z_exponent);
        end
        state <= InDirection;
      end

      default: state <= InIdle;
    endcase

    if (sums_made) begin
      starting <= 1'b0;
      if (takes_first) take_first_residual();
      else take_residual();
    end

    if (reset) begin
      state <= InIdle;
      start <= 1'b0;
      divides <= 1'b0;
      clocks_left <= '0;
      starting <= 1'b0;
      finished <= 1'b0;
      iteration_made <= 1'b0;
    end
  end

  task automatic take_first_residual();
    z_r <= new_z_r;
    scalar_overflow <= scalar_overflow || z_r_overflows;
    scalar_exponent <= r_exponent + z_exponent;
    d_exponent <= z_exponent + first_up;
    r_shift <= E'(BelowR) - first_up;
  endtask

  // The new residual's z.r, and beta from it; without a residual there is no direction of old.
  task automatic take_residual();
    divides <= 1'b1;
    denominator <= hold ? (S - 1)'(1) : z_r[S-2:0];
    numerator <= new_z_r[S-2:0];
    holds_division <= hold || no_z_r;
    clears_beta <= !hold && no_z_r;
    if (!hold) begin
      z_r <= new_z_r;
      scalar_overflow <= scalar_overflow || z_r_overflows;
      scalar_exponent <= r_exponent + z_exponent;
      scalar_exponent_before <= scalar_exponent;
    end
  endtask

endmodule

`default_nettype wire
