// The vector unit: Lanes nodes a clock through the passes of the sequencer, and the rows
// that the partitions finish (engine::VectorUnit). Its ranks are those of vector_lane.sv; words are
// written at rank PhaseClocks - 5 and the pass is over when the last group's rank is PhaseClocks - 1,
// a row's VectorClocks - 1 edges after it was taken. With a preconditioner the words of z and z.r
// follow, up to rank 23.
//
// A bank of d has DirectionAccesses a clock. Writes come first; a group that has no accesses left to
// be read with waits.
`default_nettype none

module vector_unit
  import engine_types::*;
#(
    parameter int Preconditioner = 0,  // of Jacobi, of blocks
    parameter int Lanes = 2,
    parameter int Partitions = 5,
    parameter int VectorBits = 16,
    parameter int ResidualBits = 16,
    parameter int DirectionBits = 16,
    parameter int ProductBits = 32,
    parameter int CoefficientBits = 16,
    parameter int StaticBits = 4,
    parameter int ProductShift = 0,
    parameter int SumBits = 38,
    parameter int NodeBits = 10,
    parameter int QueueBits = 4,
    parameter int DotBits = 60,
    parameter int SquareBits = 60,
    parameter int PhaseClocks = 20,
    parameter int DirectionBanks = 1,
    parameter int DirectionAccesses = 4,
    parameter int DirectionWriteAccesses = 1,
    localparam int InverseWords = inverse_words(Preconditioner),
    localparam int InverseWidth = inverse_bits(Preconditioner),
    localparam int DifferenceBits =
        difference_bits(VectorBits, StaticBits, ProductBits, ProductShift),
    localparam int BankBits = Lanes > 1 ? $clog2(Lanes) : 0,
    localparam int LaneBits = Lanes > 1 ? BankBits : 1,
    localparam int AddressBits = NodeBits - BankBits
) (
    input wire clock,
    input wire reset,
    input wire [NodeBits:0] nodes,
    input wire rounding_t rounding,
    input wire [StaticBits-1:0] static_shift,
    // The host's port, while no pass runs.
    input wire host_x_write,
    input wire host_b_write,
    input wire [NodeBits-1:0] host_node,
    input wire [1:0] host_component,
    input wire [ResidualBits-1:0] host_word,
    output wire [VectorBits-1:0] host_x,  // three clocks behind the address
    // From the sequencer; what follows `start` holds still while the pass runs.
    input wire start,
    input wire pass_t pass,
    input wire hold,
    input wire compare,
    input wire first,
    input wire zero,
    input wire alone,
    input wire exchange,
    input wire [CoefficientBits-2:0] coefficient,
    input wire wide,  // the preconditioner works
    input wire [5:0] inverse_shift,
    input wire [6:0] right_d,
    input wire [6:0] right_q,
    input wire [6:0] right_r,
    input wire beyond_d,
    input wire beyond_q,
    input wire beyond_r,
    input wire clear_clamped,
    // To the sequencer.
    output logic done,
    output wire signed [DotBits-1:0] dot,
    output wire [SquareBits-1:0] squares,
    output wire signed [SquareBits:0] z_dot_r,
    output wire [ResidualBits-2:0] largest_r,
    output wire [ResidualBits-2:0] largest_z,
    output wire [VectorBits-2:0] largest_d,
    output wire [ProductBits-2:0] largest_q,
    output wire [DifferenceBits-1:0] widest,
    output wire [31:0] clamped,
    // P^-1, while no pass needs it: its words come two clocks behind the address.
    input wire inverts,
    input wire [NodeBits-1:0] inverse_node,
    input wire [1:0] inverse_component,
    input wire inverse_write,
    input wire [InverseWords-1:0][InverseWidth-1:0] inverse_new,
    output wire [InverseWords-1:0][InverseWidth-1:0] inverse_word,
    // The partitions.
    output wire product,  // a product runs
    output wire product_ended,
    input wire [Partitions-1:0] partition_finishes,
    input wire [Partitions-1:0][NodeBits-1:0] partition_finishing_node,
    input wire [Partitions-1:0][QueueBits:0] finished,
    output wire [Partitions-1:0][QueueBits:0] taken,
    output wire [Partitions-1:0][QueueBits-1:0] behind,
    input wire [Partitions-1:0][LaneBits-1:0] behind_lane,
    input wire [Partitions-1:0][NodeBits-1:0] partition_node,
    input wire [Partitions-1:0][2:0][SumBits-1:0] partition_sum,
    input wire [Partitions-1:0][2:0][VectorBits-1:0] partition_own,
    output wire [NodeBits-1:0] direction_read,
    input wire [Lanes-1:0][2:0][VectorBits-1:0] direction_words,
    output logic [Lanes-1:0] direction_write,
    output logic [NodeBits-1:0] direction_first,
    output wire [Lanes-1:0][2:0][VectorBits-1:0] direction_new
);

  localparam int V = VectorBits;
  localparam int R = ResidualBits;
  localparam int Q = ProductBits;
  localparam int Square = Preconditioner != 0 ? 15 : 14;  // ranks
  localparam int Last = PhaseClocks < 20 ? 18 : PhaseClocks - 2;
  localparam int Written = PhaseClocks - 5;
  localparam int VectorClocks = PhaseClocks - 9;
  localparam int RowWritten = VectorClocks - 2;  // the rank before the edge that writes q

  // ---- The pass. `active` is its first clock, too.
  logic running;
  logic [NodeBits:0] next_node, done_nodes;
  wire active = running || start;
  assign product = active && pass == Product;
  wire moves = active && pass != Product && pass != NoPass;
  wire [NodeBits:0] entering = start ? '0 : next_node;
  logic [Lanes-1:0] wants, enters;
  always_comb for (int l = 0; l < Lanes; ++l) begin
    wants[l] = moves && entering + (NodeBits + 1)'(l) < nodes;
  end

  // Ranks: the group's first node, and which lanes have a node.
  logic [NodeBits-1:0] node[Last+1];
  logic [Lanes-1:0] valid[Last+1];

  // A bank's nodes of the group that wants to enter, and of the one that is written.
  wire writes_d = pass == Copy || pass == Guess || pass == FirstDirection || pass == Direction ||
                  exchange;
  wire reads_d = pass == Update || pass == Direction || (pass == Residual && exchange);
  logic [3:0] accesses;
  always_comb begin
    accesses = '0;
    for (int l = 0; l < Lanes; l += DirectionBanks) begin
      accesses = accesses + 4'(wants[l]);
      if (writes_d && valid[Written-1][l] && !start) begin
        accesses = accesses + 4'(DirectionWriteAccesses);
      end
    end
  end
  assign enters = reads_d && accesses > 4'(DirectionAccesses) ? '0 : wants;
  always_ff @(posedge clock) begin
    node[0] <= entering[NodeBits-1:0];
    valid[0] <= enters;
    for (int i = 1; i <= Last; ++i) begin
      node[i] <= node[i-1];
      valid[i] <= start || reset ? '0 : valid[i-1];
    end
    if (reset) valid[0] <= '0;
  end

  // Of nodes that have an r: their z is still on its way when the next pass begins.
  logic [Lanes-1:0] with_z[12:21];
  wire makes_z = wide && !hold && (pass == Residual || (pass == Update && !exchange));
  always_ff @(posedge clock) begin
    with_z[12] <= makes_z && !reset ? valid[11] : '0;
    for (int i = 13; i <= 21; ++i) with_z[i] <= reset ? '0 : with_z[i-1];
  end

  // ---- Rows.
  wire [Lanes-1:0] row_valid;
  wire [Lanes-1:0][NodeBits-1:0] row_node;
  wire [Lanes-1:0][2:0][SumBits-1:0] row_sum;
  wire [Lanes-1:0][2:0][V-1:0] row_own;
  logic [Partitions-1:0][LaneBits-1:0] finishing_lane;
  always_comb begin
    for (int p = 0; p < Partitions; ++p) begin
      finishing_lane[p] = partition_finishing_node[p][LaneBits-1:0];
    end
  end
  wire unused_nodes = &{1'b0, partition_finishing_node};
  row_collector #(
      .Partitions(Partitions),
      .Lanes(Lanes),
      .NodeBits(NodeBits),
      .CountBits(QueueBits + 1),
      .SumBits(SumBits),
      .VectorBits(V)
  ) collector (
      .clock,
      .reset,
      .empties(product_ended),
      .finishes(partition_finishes),
      .finishing_lane,
      .finished,
      .taken,
      .behind,
      .behind_lane,
      .node(partition_node),
      .sum(partition_sum),
      .own(partition_own),
      .row_valid,
      .row_node,
      .row_sum,
      .row_own
  );
  logic [Lanes-1:0] rows[1:RowWritten];
  logic [Lanes-1:0][NodeBits-1:0] row_nodes[1:RowWritten];
  logic [Lanes-1:0][2:0][V-1:0] own1, own2;
  always_ff @(posedge clock) begin
    rows[1] <= reset ? '0 : row_valid;
    row_nodes[1] <= row_node;
    for (int i = 2; i <= RowWritten; ++i) begin
      rows[i] <= reset ? '0 : rows[i-1];
      row_nodes[i] <= row_nodes[i-1];
    end
    own1 <= row_own;
    own2 <= own1;
  end

  // ---- Lanes.
  wire [LaneBits-1:0] host_lane = Lanes > 1 ? host_node[LaneBits-1:0] : '0;
  wire [LaneBits-1:0] inverse_lane = Lanes > 1 ? inverse_node[LaneBits-1:0] : '0;
  wire is_product = pass == Product;
  wire [Lanes-1:0][2:0][Q-1:0] q2;
  wire [Lanes-1:0][2:0] q_clamped2, b_clamped3, sum_clamped11, r_clamped11;
  wire [Lanes-1:0][2:0][DifferenceBits-1:0] difference4;
  wire [Lanes-1:0][2:0][Q+V-1:0] q_d6;
  wire [Lanes-1:0][2:0][V-1:0] sum_word11;
  wire [Lanes-1:0][2:0][R-1:0] r_word11;
  wire [Lanes-1:0][2:0][2*R-3:0] square;
  wire [Lanes-1:0][2:0][2*R-2:0] z_r21;
  wire [Lanes-1:0][2:0][R-2:0] z_size18;
  wire [Lanes-1:0][2:0][InverseWords-1:0][InverseWidth-1:0] inverse;
  wire [Lanes-1:0][2:0][V-1:0] x_read;

  for (genvar l = 0; l < Lanes; ++l) begin : g_lane
    wire [AddressBits-1:0] read_row = node[0][NodeBits-1:BankBits];
    wire [AddressBits-1:0] host_row = host_node[NodeBits-1:BankBits];
    wire [AddressBits-1:0] inverse_row = inverse_node[NodeBits-1:BankBits];
    wire host_here = host_lane == LaneBits'(l);
    wire written = valid[Written-1][l] && !hold && !reset;
    for (genvar c = 0; c < 3; ++c) begin : g_component
      wire host_component_here = host_here && host_component == 2'(c);
      vector_component #(
          .Preconditioner(Preconditioner),
          .Component(c),
          .VectorBits(V),
          .ResidualBits(R),
          .DirectionBits(DirectionBits),
          .ProductBits(Q),
          .CoefficientBits(CoefficientBits),
          .StaticBits(StaticBits),
          .ProductShift(ProductShift),
          .SumBits(SumBits),
          .AddressBits(AddressBits),
          .PhaseClocks(PhaseClocks)
      ) component (
          .clock,
          .pass,
          .zero,
          .exchange,
          .alone,
          .rounding,
          .static_shift,
          .coefficient,
          .wide,
          .inverse_shift,
          .right_d,
          .right_q,
          .right_r,
          .beyond_d,
          .beyond_q,
          .beyond_r,
          .read_address(active ? read_row : host_row),
          .b_address(is_product ? row_node[l][NodeBits-1:BankBits] : read_row),
          .written,
          .written_address(node[Written-1][NodeBits-1:BankBits]),
          .previous_write(valid[2][l] && pass == Guess && !reset),
          .previous_address(node[2][NodeBits-1:BankBits]),
          .q_write(rows[RowWritten][l] && !hold && !reset),
          .q_address(row_nodes[RowWritten][l][NodeBits-1:BankBits]),
          .z_write(with_z[18][l]),
          .z_address(node[18][NodeBits-1:BankBits]),
          .inverse_read_address(inverts ? inverse_row : node[10][NodeBits-1:BankBits]),
          .inverse(inverse[l][c]),
          .inverse_write(inverse_write && inverse_lane == LaneBits'(l) &&
                         inverse_component == 2'(c)),
          .inverse_address(inverse_row),
          .inverse_new,
          .host_x_write(host_x_write && host_component_here),
          .host_b_write(host_b_write && host_component_here),
          .host_address(host_row),
          .host_word,
          .x(x_read[l][c]),
          .d(is_product ? own2[l][c] : direction_words[l][c]),
          .sum(row_sum[l][c]),
          .q2(q2[l][c]),
          .q_clamped2(q_clamped2[l][c]),
          .b_clamped3(b_clamped3[l][c]),
          .difference4(difference4[l][c]),
          .q_d6(q_d6[l][c]),
          .sum_word11(sum_word11[l][c]),
          .r_word11(r_word11[l][c]),
          .node_r11(r_word11[l]),
          .sum_clamped11(sum_clamped11[l][c]),
          .r_clamped11(r_clamped11[l][c]),
          .square(square[l][c]),
          .z_size18(z_size18[l][c]),
          .z_r21(z_r21[l][c]),
          .direction_new(direction_new[l][c])
      );
    end
    always_ff @(posedge clock) direction_write[l] <= written && writes_d;
  end
  assign direction_read = node[0];
  always_ff @(posedge clock) direction_first <= node[Written-1];

  // The host's word of x.
  logic [V-1:0] selected;
  logic [InverseWords-1:0][InverseWidth-1:0] selected_inverse;
  always_comb begin
    selected = '0;
    selected_inverse = '0;
    for (int l = 0; l < Lanes; ++l) begin
      for (int c = 0; c < 3; ++c) begin
        if (host_lane == LaneBits'(l) && host_component == 2'(c)) begin
          selected = x_read[l][c];
        end
        if (inverse_lane == LaneBits'(l) && inverse_component == 2'(c)) begin
          selected_inverse = inverse[l][c];
        end
      end
    end
  end
  assign host_x = selected;
  assign inverse_word = selected_inverse;

  vector_sums #(
      .Preconditioner(Preconditioner),
      .Lanes(Lanes),
      .VectorBits(V),
      .ResidualBits(R),
      .ProductBits(Q),
      .DifferenceBits(DifferenceBits),
      .DotBits(DotBits),
      .SquareBits(SquareBits)
  ) sums (
      .clock,
      .start,
      .clear_clamped,
      .pass,
      .hold,
      .compare,
      .exchange,
      .counts_b(pass == Residual && first && !hold),
      .wide,
      .rows2(rows[2]),
      .rows4(rows[4]),
      .square_rows(rows[Square-9]),
      .rows6(rows[6]),
      .q2,
      .q_clamped2,
      .difference4,
      .q_d6,
      .nodes3(valid[3]),
      .nodes11(valid[11]),
      .square_nodes(valid[Square]),
      .nodes18(with_z[18]),
      .nodes21(with_z[21]),
      .b_clamped3,
      .sum_word11,
      .r_word11,
      .sum_clamped11,
      .r_clamped11,
      .square,
      .z_size18,
      .z_r21,
      .dot,
      .squares,
      .z_dot_r,
      .largest_r,
      .largest_z,
      .largest_d,
      .largest_q,
      .widest,
      .clamped
  );

  // ---- The end: nodes that are summed, or rows that are written. What an index word's flipped bit
  // has a product leave in partitions and collector goes, so that the next product has its own rows.
  assign product_ended = done && is_product;
  logic [NodeBits:0] more;
  always_comb begin
    more = '0;
    for (int l = 0; l < Lanes; ++l) begin
      if (is_product ? rows[RowWritten][l] : valid[PhaseClocks-2][l]) more = more + 1'b1;
    end
  end
  wire [NodeBits:0] total = done_nodes + more;
  always_ff @(posedge clock) begin
    done <= 1'b0;
    if (moves) next_node <= enters == '0 ? entering : entering + (NodeBits + 1)'(Lanes);
    if (running) begin
      done_nodes <= total;
      if (total == nodes) begin
        running <= 1'b0;
        done <= 1'b1;
      end
    end
    if (start) begin
      running <= pass != NoPass && nodes != '0;
      done <= nodes == '0;
      done_nodes <= '0;
    end
    if (reset) begin
      running <= 1'b0;
      done <= 1'b0;
    end
  end

endmodule

`default_nettype wire
