// Takes rows from the partitions' result memories: at every clock one of a partition and one for a
// memory of q, up to Lanes, in turn from the partition behind the one that was served last
// (engine::VectorUnit::collect). A row goes to the lane of its node's memory.
//
// Who gives is found a clock ahead, of what a partition will have then, so that the words of a row only
// go through a selection.
//
// The first partition that is passed over, because its memory of q is taken while another one is
// free, has the next turn. Whoever has a turn is served, so that no row waits for Partitions clocks.
`default_nettype none

module row_collector #(
    parameter int Partitions = 5,
    parameter int Lanes = 2,
    parameter int NodeBits = 10,
    parameter int CountBits = 5,
    parameter int SumBits = 38,
    parameter int VectorBits = 16,
    localparam int LaneBits = Lanes > 1 ? $clog2(Lanes) : 1
) (
    input wire clock,
    input wire reset,
    input wire empties,  // a product is over: rows that nobody waits for go, and the turn stays
    // A row that is finished with the next edge, and the lane of its node.
    input wire [Partitions-1:0] finishes,
    input wire [Partitions-1:0][LaneBits-1:0] finishing_lane,
    // Both count rows, modulo twice the depth of a result memory.
    input wire [Partitions-1:0][CountBits-1:0] finished,
    output logic [Partitions-1:0][CountBits-1:0] taken,
    // The place behind that of the row which waits longest, and the lane of the node there.
    output logic [Partitions-1:0][CountBits-2:0] behind,
    input wire [Partitions-1:0][LaneBits-1:0] behind_lane,
    // The row that each partition has waited with longest.
    input wire [Partitions-1:0][NodeBits-1:0] node,
    input wire [Partitions-1:0][2:0][SumBits-1:0] sum,
    input wire [Partitions-1:0][2:0][VectorBits-1:0] own,
    // The rows that were taken at the edge before.
    output logic [Lanes-1:0] row_valid,
    output logic [Lanes-1:0][NodeBits-1:0] row_node,
    output logic [Lanes-1:0][2:0][SumBits-1:0] row_sum,
    output logic [Lanes-1:0][2:0][VectorBits-1:0] row_own
);


  logic [Partitions-1:0] first, next_first;  // the one whose turn it is
  logic [Lanes-1:0][Partitions-1:0] given;  // to a lane by a partition
  logic [Partitions-1:0] gives, next_gives;           // to any

  // ---- Whether a partition has a row with the next edge.
  logic [Partitions-1:0] any, several, next_any, next_several;
  always_comb begin
    for (int p = 0; p < Partitions; ++p) begin
      automatic logic [CountBits-1:0] waiting = finished[p] - taken[p];
      next_any[p] = finishes[p] || (gives[p] ? several[p] : any[p]);
      next_several[p] = finishes[p] == gives[p] ? waiting > CountBits'(1)
                        : finishes[p] ? waiting != '0 : waiting > CountBits'(2);
    end
  end
  // In the order of turns those from the first one come before the others: what is found before a
  // partition is found among its own, and for the others among all of the former too.
  logic [Partitions-1:0] begins, next_begins;  // not before the first one
  always_comb begin
    next_begins = '0;
    for (int p = 0; p < Partitions; ++p) begin
      for (int t = 0; t <= p; ++t) next_begins[p] = next_begins[p] | next_first[t];
    end
  end
  function automatic logic [Partitions-1:0] has_before(input logic [Partitions-1:0] these,
                                                   input logic [Partitions-1:0] begins_at);
    for (int p = 0; p < Partitions; ++p) begin
      automatic logic [Partitions-1:0] lower = these & Partitions'((1 << p) - 1);
      has_before[p] = begins_at[p] ? |(lower & begins_at) : |lower || |(these & begins_at);
    end
  endfunction

  // Each lane takes the first row that is its own.
  logic [Lanes-1:0][Partitions-1:0] wants, next_wants, taken_before, next_taken_before, next_given;
  logic [Partitions-1:0] passed_over, has_all, passed_before, given_after;
  always_comb begin
    next_gives = '0;
    for (int l = 0; l < Lanes; ++l) begin
      for (int p = 0; p < Partitions; ++p) begin
        // The row that waits longest then is the one behind, the same, or the one that is finished.
        next_wants[l][p] =
            gives[p] && several[p] ? Lanes == 1 || behind_lane[p] == LaneBits'(l) :
            !gives[p] && any[p] ? wants[l][p] :
            finishes[p] && (Lanes == 1 || finishing_lane[p] == LaneBits'(l));
      end
      // Of what is found for each turn, that of the one which will have it.
      next_taken_before[l] = '0;
      for (int t = 0; t < Partitions; ++t) begin
        automatic logic earlier = 1'b0;
        for (int i = t; i < t + Partitions; ++i) begin
          next_taken_before[l][i%Partitions] =
              next_taken_before[l][i%Partitions] | (next_first[t] & earlier);
          earlier = earlier | next_wants[l][i%Partitions];
        end
      end
      next_given[l] = next_wants[l] & ~next_taken_before[l];
      next_gives = next_gives | next_given[l];
    end
  end
  always_comb begin
    passed_over = '0;
    has_all = '1;
    for (int l = 0; l < Lanes; ++l) begin
      passed_over = passed_over | (wants[l] & taken_before[l]);
      has_all = has_all & taken_before[l];
    end
    passed_over = passed_over & ~has_all;
  end
  logic [Lanes-1:0][NodeBits-1:0] given_node;
  logic [Lanes-1:0][2:0][SumBits-1:0] given_sum;
  logic [Lanes-1:0][2:0][VectorBits-1:0] given_own;
  always_comb begin
    given_node = '0;
    given_sum = '0;
    given_own = '0;
    for (int l = 0; l < Lanes; ++l) begin
      for (int p = 0; p < Partitions; ++p) begin
        if (given[l][p]) begin
          given_node[l] = given_node[l] | node[p];
          given_sum[l] = given_sum[l] | sum[p];
          given_own[l] = given_own[l] | own[p];
        end
      end
    end
  end

  // The next turn is that of the first one that is passed over, or of the one behind the last that gives.
  always_comb begin
    passed_before = has_before(passed_over, begins);
    for (int p = 0; p < Partitions; ++p) begin
      automatic logic [Partitions-1:0] higher = gives & ~Partitions'((2 << p) - 1);
      given_after[p] = begins[p] ? |higher || |(gives & ~begins) : |(higher & ~begins);
    end
    for (int p = 0; p < Partitions; ++p) begin
      next_first[p] = passed_over != '0 ? passed_over[p] && !passed_before[p] :
                      gives == '0 ? first[p] :
                      gives[p>0?p-1 : Partitions-1] && !given_after[p>0?p-1 : Partitions-1];
    end
  end

  always_ff @(posedge clock) begin
    first <= next_first;
    begins <= next_begins;
    any <= next_any;
    several <= next_several;
    given <= next_given;
    gives <= next_gives;
    wants <= next_wants;
    taken_before <= next_taken_before;
    for (int l = 0; l < Lanes; ++l) row_valid[l] <= |given[l];
    row_node <= given_node;
    row_sum <= given_sum;
    row_own <= given_own;
    for (int p = 0; p < Partitions; ++p) begin
      if (gives[p]) begin
        taken[p] <= taken[p] + 1'b1;
        behind[p] <= behind[p] + 1'b1;
      end
    end
    if (empties) begin
      first <= first;
      begins <= begins;
    end
    if (reset) begin
      first <= Partitions'(1);
      begins <= '1;
    end
    if (reset || empties) begin
      any <= '0;
      several <= '0;
      given <= '0;
      gives <= '0;
      wants <= '0;
      taken_before <= '0;
      row_valid <= '0;
      taken <= '0;
      for (int p = 0; p < Partitions; ++p) behind[p] <= (CountBits - 1)'(1);
    end
  end

  wire unused = &{1'b0, finishing_lane, behind_lane};  // with one lane

endmodule

`default_nettype wire
