// The engine of thesis chapter 5, with a preconditioner or without: partitions of the matrix, the vector unit, the
// sequencer with its divider, and the host's port. The words and clocks of engine::CycleEngine are
// those of this module (docs/rtl.md).
//
// Clocks are counted from the one behind the clock in which `go`, `copy`, `invert` or `edit` is seen; the
// engine is idle again behind the last one. `reset` aborts whatever runs and leaves the memories and
// the settings as they are.
`default_nettype none

module engine
  import engine_types::*;
#(
    parameter int Preconditioner = 0,  // z and P^-1, 1 of Jacobi, 2 of blocks; without them r is as long as x
    parameter int MatrixBits = 12,
    parameter int VectorBits = 16,
    parameter int CoefficientBits = 16,
    parameter int ScalarBits = 64,
    parameter int Package = 8,
    parameter int Partitions = 5,
    parameter int Lanes = 2,
    parameter int NodeBits = 10,       // 2^NodeBits nodes at most
    parameter int PackageBits = 11,    // 2^PackageBits packages of a partition at most
    parameter int QueueBits = 4,
    parameter int PhaseClocks = 20,
    parameter int DivisionClocks = 68,
    parameter int StaticBits = 4,
    parameter int RowsInParallel = 3,
    parameter int DirectionBanks = 1,
    parameter int DirectionMemory = 0,  // accel::DirectionMemory: double-pumped, two copies, stall
    parameter int BlockBits = 6        // 2^BlockBits blocks of a row at most, for the editor
) (
    input wire clock,
`ifdef ECP5
    input wire clock2,  // of the copies of d, twice as fast
`endif
    input wire reset,
    // The host's port, while the engine is idle. Words of x come three clocks behind the address.
    input wire host_write,
    input wire space_t host_space,
    input wire [31:0] host_address,
    input wire [31:0] host_word,
    output wire [31:0] host_read,
    // Orders.
    input wire go,
    input wire copy,
    input wire invert,           // P^-1 of all nodes: behind a load
    input wire edit,             // the matrix, as the settings say
    input wire forget_previous,  // an extrapolated start then has no solution before x
    // What a solve has come to.
    output wire [3:0] state_number,
    output wire editing,
    output wire finished,
    output wire iteration_made,
    output wire breakdown,
    output wire reached,
    output wire scalar_overflow,
    output wire [15:0] iterations_made,
    output wire [15:0] replacements,
    output wire [31:0] clamped,
    // Registers that an iteration can be told by; signed, and as wide for every size of the engine.
    output wire [31:0] alpha,
    output wire [31:0] alpha_exponent,
    output wire [31:0] beta,
    output wire [31:0] beta_exponent,
    output wire [31:0] r_exponent,
    output wire [31:0] z_exponent,
    output wire [31:0] d_exponent,
    output wire [63:0] z_r,
    output wire [63:0] d_q,
    // Clocks in which packages of any partition have waited since the solve began: for the banks of
    // d or the rows, and for room for a finished row.
    output wire [31:0] turn_waits,
    output wire [31:0] room_waits
);

  localparam int ProductBits = 32;
  localparam int GrowthBits = 4;  // of a row's sum, thesis section 5.5
  localparam int Excess = MatrixBits + VectorBits + GrowthBits - ProductBits;
  localparam int ProductShift = Excess > 0 ? Excess : 0;
  // No row's exact sum is longer: of 2^BlockBits blocks at most, with three columns each.
  localparam int RowBits =
      MatrixBits + VectorBits + (NodeBits > BlockBits ? NodeBits : NodeBits + 1);
  localparam int SumBits = RowBits > ProductBits ? RowBits : ProductBits + 1;
  localparam int ResidualBits = Preconditioner != 0 ? WideBits : VectorBits;
  localparam int DirectionBits =
      direction_bits(Preconditioner, VectorBits, MatrixBits, ProductShift);
  // z.r is there with rank 23, a pass is over with rank PhaseClocks - 1.
  localparam int LateSums = Preconditioner != 0 && PhaseClocks < 24 ? 24 - PhaseClocks : 0;
  localparam int DotBits = ProductBits + VectorBits + NodeBits + 1;
  localparam int SquareBits = 2 * ResidualBits - 2 + NodeBits + 2;
  localparam int ExponentBits = 22;
  localparam int DifferenceBits = difference_bits(VectorBits, StaticBits, ProductBits, ProductShift);
  localparam int Nodes = Package % 3 == 0 ? Package / 3 : (Package + 1) / 3 + 1;

  // What is not built: the arithmetic below leaves no room for it.
  localparam int DirectionAccesses = DirectionMemory == 2 ? 2 : 4;
  localparam int WriteAccesses = DirectionMemory == 1 ? 2 : 1;
  localparam int InBank = (Lanes + DirectionBanks - 1) / DirectionBanks;
  if (2 ** $clog2(Lanes) != Lanes || 2 ** $clog2(DirectionBanks) != DirectionBanks) begin
    $error("lanes and banks of d are bits of a node's number");
  end
  if (InBank > 2) $error("a memory of d takes two words of a pass: more banks are needed");
  if ($clog2(DirectionBanks) >= NodeBits) $error("more banks of d than nodes");
  if (Package > 16) $error("the adder tree has ranks for 16 products");
  if (RowsInParallel < 1 || RowsInParallel > 3) $error("a package has three rows");
  if (RowsInParallel < 3 && Nodes > DirectionAccesses) begin
    $error("the first rows would need words that the banks of d have not read");
  end
  if (PhaseClocks < 19) $error("the lanes have ranks up to 18");
  if (DivisionClocks < (ScalarBits - 1) / 8 + CoefficientBits + 41 + LateSums) begin
    $error("the divider and the scaler take longer than a division");
  end
  // Of a node: what looks its row up, whose packages are a clock each, and three serial divisions.
  localparam int MostPackages = (3 * 2 ** BlockBits + Package - 1) / Package;
  localparam int InverseClocks = 14 + MostPackages + 3 * (MatrixBits + InverseBits + 5);
  if (Preconditioner == 1 && 3 * DivisionClocks < InverseClocks) begin
    $error("a node's words of the inverse diagonal take longer than three divisions");
  end
  // And with blocks their products, six quotients and three rows.
  localparam int BlockClocks = 14 + MostPackages + 34 + 6 * (3 * MatrixBits + InverseBits + 1);
  if (Preconditioner == 2 && 6 * DivisionClocks < BlockClocks) begin
    $error("a node's words of the inverse block take longer than six divisions");
  end

  // ---- Settings.
  wire [NodeBits:0] nodes;
  wire [15:0] iterations, replace_every;
  wire [4:0] static_shift, target, threshold, step;
  wire starts_zero, extrapolated, dynamic_scaling, scaling_down, preconditions;
  wire rounding_t shift_rounding, division_rounding;
  wire [52:0] tolerance;
  wire signed [11:0] tolerance_exponent;
  wire [NodeBits-1:0] edited_node;
  wire restores;
  wire [MatrixBits-1:0] diagonal;
  engine_settings #(
      .VectorBits(VectorBits),
      .MatrixBits(MatrixBits),
      .NodeBits(NodeBits)
  ) settings (
      .clock,
      .write(host_write && host_space == SpaceSettings),
      .address(host_address[3:0]),
      .word(host_word),
      .nodes,
      .iterations,
      .replace_every,
      .static_shift,
      .target,
      .threshold,
      .step,
      .starts_zero,
      .extrapolated,
      .dynamic_scaling,
      .scaling_down,
      .preconditions,
      .shift_rounding,
      .division_rounding,
      .tolerance,
      .tolerance_exponent,
      .edited_node,
      .restores,
      .diagonal
  );

  // ---- The sequencer.
  wire start, hold, compare, first, zero, alone, exchange;
  wire pass_t pass;
  wire [CoefficientBits-2:0] coefficient, alpha_mantissa, beta_mantissa;
  wire [6:0] right_d, right_q, right_r;
  wire beyond_d, beyond_q, beyond_r;
  wire done;
  wire signed [DotBits-1:0] dot;
  wire [SquareBits-1:0] squares;
  wire signed [SquareBits:0] z_dot_r;
  wire [ResidualBits-2:0] largest_r, largest_z;
  wire [VectorBits-2:0] largest_d;
  wire [ProductBits-2:0] largest_q;
  wire [DifferenceBits-1:0] widest;
  wire state_t state;
  wire signed [ExponentBits-1:0] alpha_shift, change_shift, beta_shift, r_shift, z_shift, d_shift;
  wire signed [ScalarBits-1:0] z_r_word, d_q_word;
  wire wide = Preconditioner != 0 && preconditions;
  wire [5:0] inverse_shift;
  logic has_previous;
  wire host_x = host_write && host_space == SpaceX;
  always_ff @(posedge clock) begin
    if (go) has_previous <= extrapolated;
    if (reset || forget_previous || host_x) has_previous <= 1'b0;
  end
  sequencer #(
      .Preconditioner(Preconditioner),
      .MatrixBits(MatrixBits),
      .VectorBits(VectorBits),
      .ResidualBits(ResidualBits),
      .DirectionBits(DirectionBits),
      .ProductBits(ProductBits),
      .CoefficientBits(CoefficientBits),
      .ScalarBits(ScalarBits),
      .ExponentBits(ExponentBits),
      .DifferenceBits(DifferenceBits),
      .DotBits(DotBits),
      .SquareBits(SquareBits),
      .ProductShift(ProductShift),
      .DivisionClocks(DivisionClocks),
      .LateSums(LateSums)
  ) sequence_of_passes (
      .clock,
      .reset,
      .go,
      .copy,
      .has_previous,
      .iterations,
      .replace_every,
      .starts_zero,
      .extrapolated,
      .dynamic_scaling,
      .scaling_down,
      .preconditions,
      .inverse_shift,
      .division_rounding,
      .static_shift,
      .target,
      .threshold,
      .step,
      .stops(tolerance != '0),
      .tolerance,
      .tolerance_exponent,
      .start,
      .pass,
      .hold,
      .compare,
      .first,
      .zero,
      .alone,
      .exchange,
      .coefficient,
      .right_d,
      .right_q,
      .right_r,
      .beyond_d,
      .beyond_q,
      .beyond_r,
      .done,
      .dot,
      .squares,
      .z_dot_r,
      .largest_r,
      .largest_z,
      .largest_d,
      .largest_q,
      .widest,
      .state,
      .finished,
      .iteration_made,
      .breakdown,
      .reached,
      .scalar_overflow,
      .made(iterations_made),
      .replacements,
      .alpha(alpha_mantissa),
      .alpha_exponent(alpha_shift),
      .change_exponent(change_shift),
      .beta(beta_mantissa),
      .beta_exponent(beta_shift),
      .r_exponent(r_shift),
      .z_exponent(z_shift),
      .d_exponent(d_shift),
      .z_r(z_r_word),
      .d_q(d_q_word)
  );
  assign state_number = state;
  assign alpha = 32'(alpha_mantissa);
  assign alpha_exponent = 32'(change_shift);
  assign beta = 32'(beta_mantissa);
  assign beta_exponent = 32'(beta_shift);
  assign r_exponent = 32'(r_shift);
  assign z_exponent = 32'(z_shift);
  assign d_exponent = 32'(d_shift);
  assign z_r = 64'(z_r_word);
  assign d_q = 64'(d_q_word);

  // ---- The vector unit.
  wire product, product_ended;
  wire [Partitions-1:0][QueueBits:0] rows_finished, taken;
  localparam int LaneBits = Lanes > 1 ? $clog2(Lanes) : 1;
  wire [Partitions-1:0][QueueBits-1:0] behind;
  wire [Partitions-1:0][LaneBits-1:0] behind_lane;
  wire [Partitions-1:0] row_finishes;
  wire [Partitions-1:0][NodeBits-1:0] row_node, finishing_node;
  wire [Partitions-1:0][2:0][SumBits-1:0] row_sum;
  wire [Partitions-1:0][2:0][VectorBits-1:0] row_own;
  wire [NodeBits-1:0] direction_read, direction_first;
  wire [Lanes-1:0] direction_write;
  wire [Lanes-1:0][2:0][VectorBits-1:0] direction_new;
  wire [Lanes-1:0][2:0][VectorBits-1:0] direction_words;
  wire [VectorBits-1:0] x_word;
  wire inverts, inverse_write;
  wire [NodeBits-1:0] inverse_node;
  wire [1:0] inverse_component;
  wire [inverse_words(Preconditioner)-1:0][inverse_bits(Preconditioner)-1:0] inverse_word, inverse_new;
  vector_unit #(
      .Preconditioner(Preconditioner),
      .Lanes(Lanes),
      .Partitions(Partitions),
      .VectorBits(VectorBits),
      .ResidualBits(ResidualBits),
      .DirectionBits(DirectionBits),
      .ProductBits(ProductBits),
      .CoefficientBits(CoefficientBits),
      .StaticBits(StaticBits),
      .ProductShift(ProductShift),
      .SumBits(SumBits),
      .NodeBits(NodeBits),
      .QueueBits(QueueBits),
      .DotBits(DotBits),
      .PhaseClocks(PhaseClocks),
      .DirectionBanks(DirectionBanks),
      .DirectionAccesses(DirectionAccesses),
      .DirectionWriteAccesses(WriteAccesses),
      .SquareBits(SquareBits)
  ) vectors (
      .clock,
      .reset,
      .nodes,
      .rounding(shift_rounding),
      .static_shift(static_shift[StaticBits-1:0]),
      .host_x_write(host_x),
      .host_b_write(host_write && host_space == SpaceB),
      .host_node(host_address[2+:NodeBits]),
      .host_component(host_address[1:0]),
      .host_word(host_word[ResidualBits-1:0]),
      .host_x(x_word),
      .start,
      .pass,
      .hold,
      .compare,
      .first,
      .zero,
      .alone,
      .exchange,
      .coefficient,
      .wide,
      .inverse_shift,
      .right_d,
      .right_q,
      .right_r,
      .beyond_d,
      .beyond_q,
      .beyond_r,
      .clear_clamped(go),
      .done,
      .dot,
      .squares,
      .z_dot_r,
      .largest_r,
      .largest_z,
      .largest_d,
      .largest_q,
      .widest,
      .clamped,
      .inverts,
      .inverse_node,
      .inverse_component,
      .inverse_write,
      .inverse_new,
      .inverse_word,
      .product,
      .product_ended,
      .finished(rows_finished),
      .taken,
      .behind,
      .behind_lane,
      .partition_finishes(row_finishes),
      .partition_finishing_node(finishing_node),
      .partition_node(row_node),
      .partition_sum(row_sum),
      .partition_own(row_own),
      .direction_read,
      .direction_words,
      .direction_write,
      .direction_first,
      .direction_new
  );
  assign host_read = 32'($signed(x_word));

  // ---- The partitions of the matrix, and its editor.
  matrix_partitions #(
      .Preconditioner(Preconditioner),
      .Package(Package),
      .MatrixBits(MatrixBits),
      .VectorBits(VectorBits),
      .SumBits(SumBits),
      .Partitions(Partitions),
      .Lanes(Lanes),
      .NodeBits(NodeBits),
      .PackageBits(PackageBits),
      .BlockBits(BlockBits),
      .QueueBits(QueueBits),
      .PhaseClocks(PhaseClocks),
      .RowsInParallel(RowsInParallel),
      .DirectionBanks(DirectionBanks),
      .DirectionMemory(DirectionMemory),
      .DirectionAccesses(DirectionAccesses),
      .DivisionClocks(DivisionClocks)
  ) matrix (
      .clock,
`ifdef ECP5
      .clock2,
`endif
      .reset,
      .host_write,
      .host_space,
      .host_address,
      .host_word,
      .nodes,
      .preconditions,
      .invert,
      .edit,
      .restores,
      .edited_node,
      .diagonal,
      .editing,
      .inverts,
      .inverse_node,
      .inverse_component,
      .inverse_write,
      .inverse_new,
      .inverse_word,
      .inverse_shift,
      .product,
      .product_ended,
      .start(start && pass == Product),
      .direction_read,
      .direction_words,
      .direction_write,
      .direction_first,
      .direction_new,
      .taken,
      .behind,
      .behind_lane,
      .finished(rows_finished),
      .row_finishes,
      .finishing_node,
      .row_node,
      .row_sum,
      .row_own,
      .clear_waits(go),
      .turn_waits,
      .room_waits
  );

  wire unused = &{1'b0, alpha_shift, preconditions};

endmodule

`default_nettype wire
