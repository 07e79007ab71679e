// What is proved of row_collector.sv, the arbiter of finished rows (prove.py).
`default_nettype none

module row_collector_properties #(
    parameter int Partitions = 5,
    parameter int Lanes = 2,
    parameter int NodeBits = 1,
    parameter int CountBits = 2,
    parameter int SumBits = 1,
    parameter int VectorBits = 1,
    localparam int LaneBits = Lanes > 1 ? $clog2(Lanes) : 1,
    localparam int WaitBits = $clog2(Partitions + 1) + 2
) (
    input wire clock,
    input wire reset,
    input wire empties,
    input wire [Partitions-1:0] finishes,
    input wire [Partitions-1:0][LaneBits-1:0] finishing_lane,
    input wire [Partitions-1:0][CountBits-1:0] finished,
    input wire [Partitions-1:0][CountBits-1:0] taken,
    input wire [Partitions-1:0][CountBits-2:0] behind,
    input wire [Partitions-1:0][LaneBits-1:0] behind_lane,
    input wire [Partitions-1:0][NodeBits-1:0] node,
    input wire [Partitions-1:0][2:0][SumBits-1:0] sum,
    input wire [Partitions-1:0][2:0][VectorBits-1:0] own,
    input wire [Lanes-1:0] row_valid,
    input wire [Lanes-1:0][NodeBits-1:0] row_node,
    input wire [Lanes-1:0][2:0][SumBits-1:0] row_sum,
    input wire [Lanes-1:0][2:0][VectorBits-1:0] row_own,
    // Inside.
    input wire [Partitions-1:0] first,
    input wire [Partitions-1:0] begins,
    input wire [Partitions-1:0] any,
    input wire [Partitions-1:0] several,
    input wire [Lanes-1:0][Partitions-1:0] wants,
    input wire [Lanes-1:0][Partitions-1:0] taken_before,
    input wire [Lanes-1:0][Partitions-1:0] given,
    input wire [Partitions-1:0] gives
);

  // From the first clock on: there is a reset before anything counts.
  logic past = 1'b0, after_reset = 1'b0;
  always_ff @(posedge clock) begin
    past <= 1'b1;
    after_reset <= past || reset;
  end
  always_comb if (!past) assume (reset);

  logic [Partitions-1:0] has_row;
  logic [Lanes-1:0][Partitions-1:0] of_lane;  // the rows for each memory of q
  always_comb begin
    for (int p = 0; p < Partitions; ++p) begin
      has_row[p] = finished[p] != taken[p];
      for (int l = 0; l < Lanes; ++l) of_lane[l][p] = has_row[p] && int'(node[p]) % Lanes == l;
    end
  end

  // ---- What the proof may rely on (proved of spmxv_partition.sv): a partition counts the rows that it
  // has said to finish, and no more than there is room for; the row that is shown next is the one
  // behind, or one that was said to finish.
  localparam int Depth = 2 ** (CountBits - 1);
  logic [Partitions-1:0][CountBits-1:0] waiting;
  always_comb for (int p = 0; p < Partitions; ++p) waiting[p] = finished[p] - taken[p];
  for (genvar p = 0; p < Partitions; ++p) begin : g_partition
    logic [CountBits-1:0] expected_finished;
    logic [LaneBits-1:0] expected_lane;
    always_ff @(posedge clock) begin
      expected_finished <= reset || empties ? '0 : finished[p] + CountBits'(finishes[p]);
      expected_lane <= gives[p] ? (waiting[p] > CountBits'(1) ? behind_lane[p] : finishing_lane[p])
                       : has_row[p] ? LaneBits'(int'(node[p]) % Lanes) : finishing_lane[p];
    end
    always_comb if (past) begin
      assume (finished[p] == expected_finished);
      if (has_row[p]) assume (Lanes == 1 || LaneBits'(int'(node[p]) % Lanes) == expected_lane);
    end
    always_comb if (after_reset) begin
      assume (!(finishes[p] && waiting[p] == CountBits'(Depth)));
      assert (waiting[p] <= CountBits'(Depth));
      // What was found a clock ahead.
      assert (any[p] == has_row[p]);
      assert (several[p] == (waiting[p] > CountBits'(1)));
      assert (behind[p] == (CountBits - 1)'(taken[p] + 1'b1));
      for (int l = 0; l < Lanes; ++l) assert (wants[l][p] == of_lane[l][p]);
    end
  end

  // ---- At every clock.
  int turn;
  logic [Lanes-1:0][Partitions-1:0] found_before;
  always_comb begin
    turn = 0;
    for (int p = 0; p < Partitions; ++p) if (first[p]) turn = p;
    for (int l = 0; l < Lanes; ++l) begin
      for (int p = 0; p < Partitions; ++p) begin
        found_before[l][p] = 1'b0;
        for (int o = 0; o < Partitions; ++o) begin
          // It comes before p in the order of turns.
          if (of_lane[l][o] && (o + (o < turn ? Partitions : 0) < p + (p < turn ? Partitions : 0))) begin
            found_before[l][p] = 1'b1;
          end
        end
      end
    end
  end
  always_comb if (after_reset) begin
    assert ($countones(first) == 1);
    for (int p = 0; p < Partitions; ++p) assert (begins[p] == (p >= turn));
    assert (taken_before == found_before);
    for (int l = 0; l < Lanes; ++l) assert (given[l] == (of_lane[l] & ~found_before[l]));
    assert ((gives & ~has_row) == '0);  // nobody gives what he does not have
    assert ($countones(gives) <= Lanes);
    for (int l = 0; l < Lanes; ++l) begin
      // One a memory of q, and one wherever there is any.
      assert ($countones(gives & of_lane[l]) == (|of_lane[l] ? 1 : 0));
      assert (given[l] == (gives & of_lane[l]));
    end
  end

  // ---- With the edge: what was given has been taken, once, and goes to its lane as it was.
  logic was_emptied, turn_stays;
  logic [Partitions-1:0] turn_before;
  logic [Partitions-1:0] gave;
  logic [Partitions-1:0][CountBits-1:0] were_taken;
  logic [Lanes-1:0] took;
  logic [Lanes-1:0][NodeBits-1:0] node_before;
  logic [Lanes-1:0][2:0][SumBits-1:0] sum_before;
  logic [Lanes-1:0][2:0][VectorBits-1:0] own_before;
  always_ff @(posedge clock) begin
    was_emptied <= reset || empties;
    turn_stays <= !reset && empties;
    turn_before <= first;
    gave <= gives;
    were_taken <= taken;
    took <= '0;
    for (int p = 0; p < Partitions; ++p) begin
      for (int l = 0; l < Lanes; ++l) begin
        if (gives[p] && int'(node[p]) % Lanes == l) begin
          took[l] <= 1'b1;
          node_before[l] <= node[p];
          sum_before[l] <= sum[p];
          own_before[l] <= own[p];
        end
      end
    end
  end
  always_comb if (after_reset && past) begin
    assert (first == turn_before || !turn_stays);
    for (int p = 0; p < Partitions; ++p) begin
      assert (taken[p] == (was_emptied ? '0 : were_taken[p] + CountBits'(gave[p])));
    end
    for (int l = 0; l < Lanes; ++l) begin
      assert (row_valid[l] == (took[l] && !was_emptied));
      if (row_valid[l]) begin
        assert (row_node[l] == node_before[l]);
        assert (row_sum[l] == sum_before[l]);
        assert (row_own[l] == own_before[l]);
      end
    end
  end

  // ---- Fairness. At every clock that a partition waits with a row, the one with the next turn is
  // nearer to it, and who has the turn is served. So the clocks waited and the distance that is left
  // are fewer than Partitions together.
  for (genvar p = 0; p < Partitions; ++p) begin : g_waits
    logic [WaitBits-1:0] waited;
    wire [WaitBits-1:0] distance =
        turn <= p ? WaitBits'(p - turn) : WaitBits'(p + Partitions - turn);
    always_ff @(posedge clock) begin
      waited <= reset || empties || !has_row[p] || gives[p] ? '0 : waited + 1'b1;
    end
    always_comb if (after_reset) begin
      if (has_row[p]) assert (waited + distance < WaitBits'(Partitions));
      assert (waited < WaitBits'(Partitions));
    end
  end

endmodule

bind row_collector row_collector_properties #(
    .Partitions(Partitions),
    .Lanes(Lanes),
    .NodeBits(NodeBits),
    .CountBits(CountBits),
    .SumBits(SumBits),
    .VectorBits(VectorBits)
) properties (.*);

`default_nettype wire
