// What is proved of the finished rows of spmxv_partition.sv (prove.py): the memory of rows, the
// counters beside it, and the rows that are still in the ranks and have their place already.
`default_nettype none

module row_queue_properties #(
    parameter int QueueBits = 2,
    parameter int RowBits = 8,
    localparam int Depth = 2 ** QueueBits
) (
    input wire clock,
    input wire reset,
    input wire running,                 // a product has a package left that waits for nothing else
    input wire issue,                   // one enters
    input wire edits,                   // the matrix editor reads packages
    input wire ends_row,                // it is, or would be, the last of its row
    input wire [QueueBits:0] issued,    // rows whose last package has entered
    input wire [QueueBits:0] finished,  // rows that are in the memory
    input wire [QueueBits:0] taken,
    input wire [7:0] in_ranks,          // the last package of a row is there
    input wire puts,                    // with the next edge
    input wire [RowBits-1:0] row_put,
    input wire [RowBits-1:0] rows[Depth],
    input wire [RowBits-1:0] row_shown,
    // What the collector is told of the row behind it, and of one that is put.
    input wire [QueueBits-1:0] behind,
    input wire behind_lane,
    input wire finishes,
    input wire finishing_lane,
    input wire lanes[Depth]
);

  typedef logic [QueueBits:0] count_t;
  wire count_t places_given = issued - taken;
  wire count_t rows_there = finished - taken;

  // ---- What the proof may rely on: a reset before anything counts, and a collector that takes one
  // row at a clock, and none that is not there (proved of row_collector.sv). The editor runs while no
  // product does.
  logic past = 1'b0;
  logic was_reset, was_empty;
  count_t was_taken;
  always_ff @(posedge clock) begin
    past <= 1'b1;
    was_reset <= reset;
    was_empty <= rows_there == '0;
    was_taken <= taken;
  end
  always_comb assume (!(edits && issue));
  always_comb begin
    if (!past) assume (reset);
    else if (was_reset) assume (taken == '0);
    else assume (taken == was_taken || (!was_empty && taken == was_taken + 1'b1));
  end
  logic after_reset = 1'b0;
  always_ff @(posedge clock) after_reset <= past || reset;

  // ---- No overflow: a row whose last package has entered has its place, so that a row is never
  // written over one that waits.
  always_comb if (after_reset) begin
    assert (places_given <= count_t'(Depth));
    assert (rows_there <= places_given);
    // Packages wait where there is no place for their row, and only there.
    assert (issue == (running && !(ends_row && places_given == count_t'(Depth))));
    assert (int'(count_t'(issued - finished)) == $countones(in_ranks));
    if (puts) assert (rows_there < count_t'(Depth));
  end

  // ---- The collector knows the lane of a row before it is shown, the lowest bit of its node.
  always_comb if (after_reset) begin
    assert (finishes == puts);
    if (puts) assert (finishing_lane == row_put[RowBits-1]);
    for (int i = 0; i < Depth; ++i) begin
      automatic logic [QueueBits-1:0] from_first = QueueBits'(i) - taken[QueueBits-1:0];
      if (count_t'(from_first) < rows_there) begin
        assert (lanes[i] == rows[i][RowBits-1]);
      end
    end
    assume (behind == QueueBits'(taken + 1'b1));
    if (rows_there > count_t'(1)) assert (behind_lane == rows[behind][RowBits-1]);
  end

  // ---- No loss and no other order: any one row that is put, chosen freely, is shown as it was when
  // as many have been taken as were put before it. Until then its words stay.
  wire chosen;  // free
  logic follows, was_shown;
  count_t place;
  logic [RowBits-1:0] row;
  wire count_t ahead = place - taken;
  wire gone = was_shown && taken != place;  // it was shown at the clock before, and then taken
  always_ff @(posedge clock) begin
    was_shown <= follows && !gone && taken == place;
    if (puts && chosen && !follows) begin
      follows <= 1'b1;
      place <= finished;
      row <= row_put;
    end else if (gone) begin
      follows <= 1'b0;
    end
    if (reset) follows <= 1'b0;
  end
  always_comb if (after_reset && follows && !gone) begin
    assert (ahead < rows_there);
    assert (rows[place[QueueBits-1:0]] == row);
    if (ahead == '0) assert (row_shown == row);
  end

endmodule

bind spmxv_partition row_queue_properties #(
    .QueueBits(QueueBits),
    .RowBits(RowBits)
) properties (
    .clock,
    .reset,
    .running(serves && last_turn),
    .issue,
    .edits,
    .ends_row(head_last),
    .issued,
    .finished,
    .taken,
    .in_ranks({
      valid & last, issued1 && index1[IndexBits-1], issued0 && index0[IndexBits-1]
    }),
    .puts(valid[7] && last[7]),
    .rows,
    .row_put({owner[7], next_sum, next_own}),
    .row_shown({row_node, row_sum, row_own}),
    .behind,
    .behind_lane,
    .finishes(row_finishes),
    .finishing_lane(finishing_node[0]),
    .lanes
);

`default_nettype wire
