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

  always_comb begin
    automatic logic [IndexBits-1:0] partition = first;
    automatic logic passed_over = 1'b0;
    next_first = first;
    takes = '0;
    from = '0;
    gives = '0;
    for (int i = 0; i < Partitions; ++i) begin
      automatic logic [LaneBits-1:0] lane = Lanes > 1 ? node[partition][LaneBits-1:0] : '0;
      automatic logic [IndexBits-1:0] next =
          partition == IndexBits'(Partitions - 1) ? '0 : partition + 1'b1;
      if (collects && finished[partition] != taken[partition] && !(&takes)) begin
        if (!takes[lane]) begin
          takes[lane] = 1'b1;
          from[lane] = partition;
          gives[partition] = 1'b1;
          if (!passed_over) next_first = next;
        end else if (!passed_over) begin
          passed_over = 1'b1;
          next_first = partition;
        end
      end
      partition = next;
    end
  end

  always_ff @(posedge clock) begin
    first <= next_first;
    row_valid <= takes;
    for (int l = 0; l < Lanes; ++l) begin
      row_node[l] <= node[from[l]];
      row_sum[l] <= sum[from[l]];
      row_own[l] <= own[from[l]];
    end
    for (int p = 0; p < Partitions; ++p) if (gives[p]) taken[p] <= taken[p] + 1'b1;
    if (reset) begin
      first <= '0;
      row_valid <= '0;
      taken <= '0;
    end
  end

endmodule

`default_nettype wire
