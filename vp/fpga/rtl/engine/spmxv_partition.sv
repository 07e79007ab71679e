// The SpMxV sub-block of thesis Fig. 5.5 for a partition of the matrix, as engine::SpmxvBlock has
// it: index memory, non-zero memory, copy of d, multipliers, adder trees, accumulators and the
// memory of finished rows.
//
// A package of Package columns enters with RowsInParallel of its three rows. It takes a clock, or as
// many turns as the banks of d need for its words and the rows for the multipliers, and waits where
// it ends a row for which the result memory has no room. Ranks, in edges from the one at which a
// package has its last turn:
//   0, 1 memories read     2 operands     3, 4 multipliers     5 to 7 adder tree
//   8 accumulated; the row is in the result memory
//
// The host, and the matrix editor in its place, write rows of packages and index words while no
// product runs.
`default_nettype none

module spmxv_partition #(
    parameter int Package = 8,        // columns
    parameter int MatrixBits = 12,
    parameter int VectorBits = 16,
    parameter int SumBits = 38,
    parameter int NodeBits = 10,
    parameter int PackageBits = 11,
    parameter int QueueBits = 4,      // 2^QueueBits rows wait to be taken
    parameter int Lanes = 2,
    parameter int RowsInParallel = 3,
    parameter int DirectionBanks = 1,
    parameter int DirectionMemory = 0,
    parameter int DirectionAccesses = 4,
    // Nodes that a package touches.
    localparam int Nodes = Package % 3 == 0 ? Package / 3 : (Package + 1) / 3 + 1,
    // {last, phase, owner, nodes}: the package ends its row; the component of its first column; the
    // row it belongs to; its block columns.
    localparam int IndexBits = (Nodes + 1) * NodeBits + 3,
    localparam int LaneBits = Lanes > 1 ? $clog2(Lanes) : 1
) (
    input wire clock,
`ifdef ECP5
    input wire clock2,  // of the copies of d, twice as fast
`endif
    input wire reset,
    input wire [2:0] matrix_write,  // a row of the package each
    input wire [PackageBits-1:0] matrix_write_package,
    input wire [2:0][Package-1:0][MatrixBits-1:0] matrix_write_words,
    input wire index_write,
    input wire [PackageBits-1:0] index_write_package,
    input wire [IndexBits-1:0] index_write_word,
    input wire [PackageBits:0] packages,
    input wire packages_write,  // their number is another one with the next edge
    // The editor's port: package and index word come two clocks later.
    input wire edits,
    input wire [PackageBits-1:0] edited_package,
    output wire [2:0][Package-1:0][MatrixBits-1:0] matrix_words,
    output wire [IndexBits-1:0] index_word,
    // From the sequencer.
    input wire product,   // a product runs
    input wire start,     // its first clock
    // The copy of d: what a pass reads and, with the next edge, writes.
    input wire [NodeBits-1:0] direction_read,
    output wire [Lanes-1:0][2:0][VectorBits-1:0] direction_words,
    input wire [Lanes-1:0] direction_write,
    input wire [NodeBits-1:0] direction_first,
    input wire [Lanes-1:0][2:0][VectorBits-1:0] direction_new,
    // Finished rows.
    input wire [QueueBits:0] taken,
    // The place behind that of the row which waits longest, and the lane of the node there.
    input wire [QueueBits-1:0] behind,
    output wire [LaneBits-1:0] behind_lane,
    output logic [QueueBits:0] finished,
    output wire row_finishes,  // one more is finished with the next edge: that of a node
    output wire [NodeBits-1:0] finishing_node,
    output wire [NodeBits-1:0] row_node,
    output wire [2:0][SumBits-1:0] row_sum,
    output wire [2:0][VectorBits-1:0] row_own,
    // Whether a package waits, for its turns or for room in the result memory.
    output wire waits_for_turns,
    output wire waits_for_room
);

  /* verilator no_inline_module */
  // One copy of the code for all partitions, so that it stays in the simulating processor's cache.

  localparam int ProductBits = MatrixBits + VectorBits;
  localparam int Pairs = (Package + 1) / 2;
  localparam int Fours = (Package + 3) / 4;
  localparam int R = RowsInParallel;
  localparam int RowTurns = (3 + R - 1) / R;

  // ---- Issue.
  wire [IndexBits-1:0] head, read_index;
  wire there, ends;
  logic busy;
  logic [PackageBits-1:0] position;
  logic [QueueBits:0] issued;
  logic [1:0] turn;
  wire [1:0] head_last_turn, read_last_turn;
  wire head_last = head[IndexBits-1];
  wire running = busy || (start && packages != '0);
  wire serves = running && there;
  wire last_turn = turn == head_last_turn;
  wire [QueueBits:0] waiting = issued - taken;
  wire full = head_last && waiting[QueueBits];
  wire issue = serves && last_turn && !full;
  assign waits_for_turns = serves && !last_turn;
  assign waits_for_room = serves && last_turn && full;
  index_prefetch #(
      .Bits(IndexBits),
      .PackageBits(PackageBits)
  ) index (
      .clock,
      .reset,
      .write(index_write),
      .write_package(index_write_package),
      .write_word(index_write_word),
      .packages,
      .restarts(packages_write),
      .pauses(edits),
      .paused_package(edited_package),
      .read(read_index),
      .read_last_turn,
      .takes(issue),
      .there,
      .word(head),
      .last_turn(head_last_turn),
      .ends
  );
  always_ff @(posedge clock) begin
    if (issue) position <= ends ? '0 : position + 1'b1;
    busy <= running && !(issue && ends);
    if (issue) turn <= '0;
    else if (waits_for_turns) turn <= turn + 1'b1;
    if (issue && head_last) issued <= issued + 1'b1;
    if (reset) begin
      position <= '0;
      busy <= 1'b0;
      turn <= '0;
      issued <= '0;
    end
  end
`ifndef SYNTHESIS
  // A product does not wait for its index words, or it would take more clocks.
  always_ff @(posedge clock) begin
    if (running && !there && !reset) $error("a product finds no index word");
  end
  // double_pumped_memory.sv: a vendor's may need the clock between.
  logic direction_written;
  always_ff @(posedge clock) begin
    direction_written <= direction_write != '0;
    if (product && direction_written && !reset) $error("a product begins while d is written");
  end
`endif

  // ---- The turns of a package, which are known when its word is read: of the banks where they have
  // fewer accesses than it has nodes, or of the rows.
  wire [2:0][Nodes-1:0] reads;
  wire [2:0][Nodes-1:0][2:0] number;
  if (DirectionBanks > 1 || Nodes > DirectionAccesses) begin : g_banks
    wire [1:0] bank_turn, unused_turn;
    wire [2:0][Nodes-1:0] unused_reads;
    wire [2:0][Nodes-1:0][2:0] unused_number;
    bank_reads #(
        .Package(Package),
        .NodeBits(NodeBits),
        .Banks(DirectionBanks),
        .Accesses(DirectionAccesses)
    ) reads_of_next (
        .phase(read_index[IndexBits-2-:2]),
        .node(read_index[Nodes*NodeBits-1:0]),
        .reads(unused_reads),
        .number(unused_number),
        .last_turn(bank_turn)
    );
    bank_reads #(
        .Package(Package),
        .NodeBits(NodeBits),
        .Banks(DirectionBanks),
        .Accesses(DirectionAccesses)
    ) reads_of_head (
        .phase(head[IndexBits-2-:2]),
        .node(head[Nodes*NodeBits-1:0]),
        .reads,
        .number,
        .last_turn(unused_turn)
    );
    assign read_last_turn = RowTurns > 1 ? 2'(RowTurns - 1) : bank_turn;
    wire unused = &{1'b0, bank_turn, unused_reads, unused_number, unused_turn};
  end else begin : g_bank
    assign reads = '1;
    assign number = '0;
    assign read_last_turn = 2'(RowTurns - 1);
  end

  // ---- Ranks 0 and 1: the memories.
  logic issued0, issued1;
  logic [PackageBits-1:0] package0;
  logic [IndexBits-1:0] index0, index1;
  logic [1:0] turn0, turn1;  // of the rows
  logic [2:0][Nodes-1:0] own_node0, own_node1;  // of a component the node that is the row's own
  logic [2:0][Package-1:0][MatrixBits-1:0] words1;
  wire [2:0][Nodes-1:0][VectorBits-1:0] nodes1;  // a component of each node
  always_ff @(posedge clock) begin
    // Each turn has rows of its own, or all of them go with the last one.
    issued0 <= (issue || (RowTurns > 1 && waits_for_turns)) && !reset;
    turn0 <= RowTurns > 1 ? turn : '0;
    turn1 <= turn0;
    package0 <= edits ? edited_package : position;
    index0 <= edits ? read_index : head;
    issued1 <= issued0 && !reset;
    index1 <= index0;
    own_node1 <= own_node0;
  end
  // The last one that is among the package's columns. It is found before the words are there, so
  // that they have little behind them.
  always_comb begin
    own_node0 = '0;
    for (int n = 0; n < Nodes; ++n) begin
      for (int k = 0; k < 3; ++k) begin
        if (index0[n*NodeBits+:NodeBits] == index0[Nodes*NodeBits+:NodeBits] &&
            3 * n + k >= int'(index0[IndexBits-2-:2]) &&
            3 * n + k < int'(index0[IndexBits-2-:2]) + Package) begin
          own_node0[k] = Nodes'(1) << n;
        end
      end
    end
  end
  for (genvar row = 0; row < 3; ++row) begin : g_row
    // As the index words: what is read while it is written is not used.
    (* no_rw_check *) logic [Package*MatrixBits-1:0] nonzeros[2**PackageBits];
    always_ff @(posedge clock) begin
      if (matrix_write[row]) nonzeros[matrix_write_package] <= matrix_write_words[row];
      words1[row] <= nonzeros[package0];
    end
  end
  for (genvar c = 0; c < 3; ++c) begin : g_component
    logic [Lanes-1:0][VectorBits-1:0] written, passed;
    for (genvar l = 0; l < Lanes; ++l) begin : g_lane
      assign written[l] = direction_new[l][c];
      assign direction_words[l][c] = passed[l];
    end
    direction_copy #(
        .Width(VectorBits),
        .NodeBits(NodeBits),
        .Nodes(Nodes),
        .Lanes(Lanes),
        .Banks(DirectionBanks),
        .Memory(DirectionMemory),
        .Accesses(DirectionAccesses)
    ) copy (
        .clock,
`ifdef ECP5
        .clock2,
`endif
        .product,
        .node(head[Nodes*NodeBits-1:0]),
        .reads(reads[c]),
        .number(number[c]),
        .turn,
        .word(nodes1[c]),
        .pass_node(direction_read),
        .pass_word(passed),
        .write(direction_write),
        .write_node(direction_first),
        .write_word(written)
    );
  end
  assign matrix_words = words1;
  assign index_word = index0;

  // ---- Rank 2: column c is component (phase + c) mod 3 of node (phase + c) / 3. The words of the
  // row's own node are kept as they pass.
  wire [1:0] phase1 = index1[IndexBits-2-:2];
  wire [NodeBits-1:0] owner1 = index1[Nodes*NodeBits+:NodeBits];
  logic [3*Nodes+1:0][VectorBits-1:0] in_order;  // padded: a phase of 2 looks two words further
  logic [2:0] caught1;
  logic [2:0][VectorBits-1:0] own1;
  always_comb begin
    in_order = '0;
    caught1 = '0;
    own1 = '0;
    for (int n = 0; n < Nodes; ++n) begin
      for (int k = 0; k < 3; ++k) begin
        in_order[3*n+k] = nodes1[k][n];
        caught1[k] = caught1[k] || own_node1[k][n];
        own1[k] = own1[k] | (nodes1[k][n] & {VectorBits{own_node1[k][n]}});
      end
    end
  end

  localparam int TotalBits = ProductBits + 4;  // of up to 16 products
  logic signed [VectorBits-1:0] factor_d[Package];
  logic signed [MatrixBits-1:0] factor_a[R][Package];
  logic signed [ProductBits-1:0] product3[R][Package];
  logic signed [ProductBits-1:0] product4[R][Package];
  logic signed [ProductBits:0] pair5[R][Pairs];
  logic signed [ProductBits+1:0] four6[R][Fours];
  logic signed [TotalBits-1:0] total7[R];
  logic [7:2] valid, last;
  logic [1:0] row_turn[2:7];
  logic [NodeBits-1:0] owner[2:7];
  logic [2:0] caught[2:7];
  logic [2:0][VectorBits-1:0] own[2:7];

  always_ff @(posedge clock) begin
    // Always, because it would be a net to each bit that says when.
    for (int c = 0; c < Package; ++c) begin
      case (phase1)
        2'd0: factor_d[c] <= in_order[c];
        2'd1: factor_d[c] <= in_order[c+1];
        default: factor_d[c] <= in_order[c+2];
      endcase
    end
    if (issued1) begin
      for (int c = 0; c < Package; ++c) begin
        for (int r = 0; r < R; ++r) begin
          for (int t = 0; t < RowTurns; ++t) begin
            if (turn1 == 2'(t) && t * R + r < 3) factor_a[r][c] <= words1[t*R+r<3?t*R+r : 0][c];
          end
        end
      end
    end
    for (int r = 0; r < R; ++r) begin
      if (valid[2]) begin
        for (int c = 0; c < Package; ++c) product3[r][c] <= factor_a[r][c] * factor_d[c];
      end
      if (valid[3]) product4[r] <= product3[r];
      if (valid[4]) begin
        for (int i = 0; i < Pairs; ++i) begin
          pair5[r][i] <= (ProductBits + 1)'(product4[r][2*i]);
          if (2 * i + 1 < Package) begin
            pair5[r][i] <= (ProductBits + 1)'(product4[r][2*i]) +
                           (ProductBits + 1)'(product4[r][2*i+1]);
          end
        end
      end
      if (valid[5]) begin
        for (int i = 0; i < Fours; ++i) begin
          four6[r][i] <= (ProductBits + 2)'(pair5[r][2*i]);
          if (2 * i + 1 < Pairs) begin
            four6[r][i] <= (ProductBits + 2)'(pair5[r][2*i]) + (ProductBits + 2)'(pair5[r][2*i+1]);
          end
        end
      end
      if (valid[6]) begin
        automatic logic signed [TotalBits-1:0] total = '0;
        for (int i = 0; i < Fours; ++i) total = total + TotalBits'(four6[r][i]);
        total7[r] <= total;
      end
    end
    valid <= {valid[6:2], issued1 && !reset};
    last <= {last[6:2], index1[IndexBits-1] && turn1 == 2'(RowTurns - 1)};
    row_turn[2] <= turn1;
    owner[2] <= owner1;
    caught[2] <= caught1;
    own[2] <= own1;
    for (int i = 3; i <= 7; ++i) begin
      row_turn[i] <= row_turn[i-1];
      owner[i] <= owner[i-1];
      caught[i] <= caught[i-1];
      own[i] <= own[i-1];
    end
    if (reset) valid <= '0;
  end

  // ---- Rank 8: the accumulators and the result memory.
  localparam int RowBits = NodeBits + 3 * SumBits + 3 * VectorBits;
  logic [RowBits-1:0] rows[2**QueueBits];
  logic [LaneBits-1:0] lanes[2**QueueBits];  // of their nodes
  logic [2:0][SumBits-1:0] sum, next_sum;
  logic [2:0][VectorBits-1:0] own_words, next_own;
  always_comb begin
    for (int r = 0; r < 3; ++r) begin
      next_sum[r] = sum[r];
      if (row_turn[7] == 2'(r / R)) next_sum[r] = sum[r] + SumBits'(total7[r%R]);
      next_own[r] = caught[7][r] ? own[7][r] : own_words[r];
    end
  end
  always_ff @(posedge clock) begin
    if (valid[7]) begin
      sum <= last[7] ? '0 : next_sum;
      own_words <= next_own;
      if (last[7]) begin
        rows[finished[QueueBits-1:0]] <= {owner[7], next_sum, next_own};
        lanes[finished[QueueBits-1:0]] <= owner[7][LaneBits-1:0];
        finished <= finished + 1'b1;
      end
    end
    if (reset) begin
      sum <= '0;
      finished <= '0;
    end
  end
  assign behind_lane = lanes[behind];
  assign row_finishes = valid[7] && last[7];
  assign finishing_node = owner[7];
  assign {row_node, row_sum, row_own} = rows[taken[QueueBits-1:0]];

endmodule

`default_nettype wire
