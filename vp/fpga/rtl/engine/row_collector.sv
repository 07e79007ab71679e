// Takes rows from the partitions' result memories: at every clock one of a partition and one for a
// memory of q, up to Lanes, in turn from the partition behind the one that was served last
// (engine::VectorUnit::collect). A row goes to the lane of its node's memory.
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
    parameter int VectorBits = 16
) (
    input wire clock,
    input wire reset,
    input wire collects,  // a product runs
    // Both count rows, modulo twice the depth of a result memory.
    input wire [Partitions-1:0][CountBits-1:0] finished,
    output logic [Partitions-1:0][CountBits-1:0] taken,
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

  localparam int LaneBits = Lanes > 1 ? $clog2(Lanes) : 1;
  localparam int IndexBits = Partitions > 1 ? $clog2(Partitions) : 1;

  logic [IndexBits-1:0] first, next_first;
  logic [Lanes-1:0] takes;
  logic [Lanes-1:0][IndexBits-1:0] from;
  logic [Partitions-1:0] gives;

  // In the order of turns those from the first one come before the others: what is found before a
  // partition is found among its own, and for the others among all of the former too.
  logic [Partitions-1:0] begins;  // not before the first one
  always_comb for (int p = 0; p < Partitions; ++p) begins[p] = IndexBits'(p) >= first;
  function automatic logic [Partitions-1:0] has_before(input logic [Partitions-1:0] these,
                                                   input logic [Partitions-1:0] begins_at);
    for (int p = 0; p < Partitions; ++p) begin
      automatic logic [Partitions-1:0] lower = these & Partitions'((1 << p) - 1);
      has_before[p] = begins_at[p] ? |(lower & begins_at) : |lower || |(these & begins_at);
    end
  endfunction

  // Each lane takes the first row that is its own.
  logic [Lanes-1:0][Partitions-1:0] wants, taken_before, given;
  logic [Partitions-1:0] passed_over, has_all, passed_before, given_after;
  always_comb begin
    for (int l = 0; l < Lanes; ++l) begin
      for (int p = 0; p < Partitions; ++p) begin
        wants[l][p] = collects && finished[p] != taken[p] &&
                      (Lanes == 1 || node[p][LaneBits-1:0] == LaneBits'(l));
      end
      taken_before[l] = has_before(wants[l], begins);
      given[l] = wants[l] & ~taken_before[l];
      takes[l] = |wants[l];
    end
  end
  always_comb begin
    gives = '0;
    from = '0;
    passed_over = '0;
    has_all = '1;
    for (int l = 0; l < Lanes; ++l) begin
      gives = gives | given[l];
      passed_over = passed_over | (wants[l] & taken_before[l]);
      has_all = has_all & taken_before[l];
      for (int p = 0; p < Partitions; ++p) if (given[l][p]) from[l] = from[l] | IndexBits'(p);
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
    next_first = gives == '0 ? first : '0;
    for (int p = 0; p < Partitions; ++p) begin
      if (passed_over[p] && !passed_before[p]) next_first = next_first | IndexBits'(p);
      if (passed_over == '0 && gives[p] && !given_after[p]) begin
        next_first = next_first | IndexBits'((p + 1) % Partitions);
      end
    end
  end

  always_ff @(posedge clock) begin
    first <= next_first;
    row_valid <= takes;
    row_node <= given_node;
    row_sum <= given_sum;
    row_own <= given_own;
    for (int p = 0; p < Partitions; ++p) if (gives[p]) taken[p] <= taken[p] + 1'b1;
    if (reset) begin
      first <= '0;
      row_valid <= '0;
      taken <= '0;
    end
  end

endmodule

`default_nettype wire
