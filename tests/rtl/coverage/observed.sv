// What a run of the tests has come to in the RTL engine, counted by counts.cpp (covered.py). The
// modules bind themselves to those that they look at.
`default_nettype none

module observed_engine
  import engine_types::*;
(
    input wire clock,
    input wire reset,
    input wire go,
    input wire copy,
    input wire invert,
    input wire edit,
    input wire restores,
    input wire editing,
    input wire preconditions,
    input wire state_t state,
    input wire pass_t pass,
    input wire [31:0] nodes,
    input wire starts_zero,
    input wire extrapolated,
    input wire has_previous,
    input wire dynamic_scaling,
    input wire [4:0] step,
    input wire rounding_t shift_rounding,
    input wire rounding_t division_rounding,
    input wire hold,
    input wire finished,
    input wire iteration_made,
    input wire breakdown,
    input wire reached,
    input wire scalar_overflow,
    input wire [15:0] replacements,
    input wire [31:0] clamped
);

  import "DPI-C" function void hvp_begins();
  import "DPI-C" function void hvp_ends();
  import "DPI-C" function void hvp_event(input string what, input int number);
  import "DPI-C" function void hvp_pass(input int pass);

  // Values that registers have by chance are nobody's.
  logic started;
  initial begin
    started = 1'b0;
    hvp_begins();
  end
  final hvp_ends();

  // Between the edges, when all signals are still.
  always_ff @(negedge clock) begin
    hvp_pass(int'(pass));
    if (go) started <= 1'b1;
    if (started || go) begin
      if (reset && state != InIdle) hvp_event("abort in state", int'(state));
      if (copy && !reset) hvp_event("copy of x", 0);
      if (invert && !reset) hvp_event("inverse of all nodes", int'(preconditions));
      if (edit && !reset) begin
        hvp_event("edit that restores", int'(restores));
        hvp_event("edit with a preconditioner", int'(preconditions));
      end
      if (reset && editing) hvp_event("abort of the inverse", 0);
      if (go) begin
        hvp_event("solve of nodes, 3 or more", nodes > 32'd3 ? 3 : int'(nodes));
        hvp_event("solve with a preconditioner", int'(preconditions));
        hvp_event("start from zero", int'(starts_zero));
        if (extrapolated) hvp_event("extrapolated with a solution before", int'(has_previous));
        hvp_event("dynamic scaling", int'(dynamic_scaling));
        hvp_event("scaling step", int'(step));
        hvp_event("rounding of shifts", int'(shift_rounding));
        hvp_event("rounding of divisions", int'(division_rounding));
      end
      if (iteration_made) hvp_event("iteration", 0);
      if (finished) begin
        hvp_event("end with a breakdown", int'(breakdown));
        hvp_event("end by the stop test", int'(reached));
        hvp_event("end on hold", int'(hold));
        hvp_event("end with a scalar clamped", int'(scalar_overflow));
        hvp_event("end with words clamped", int'(clamped != '0));
        hvp_event("end with residuals formed anew", int'(replacements != '0));
      end
    end
  end

endmodule

module observed_partition #(
    parameter int QueueBits = 4,
    parameter bit Turns = 1'b0  // packages take several, for the banks of d or for the multipliers
) (
    input wire clock,
    input wire reset,
    input wire start,
    input wire waits_for_turns,
    input wire waits_for_room,
    input wire empty,  // it has no row
    input wire [QueueBits:0] rows
);

  import "DPI-C" function void hvp_event(input string what, input int number);
  import "DPI-C" function void hvp_partition(input int waits, input int rows, input int depth,
                                             input int turns);

  always_ff @(posedge clock) begin
    if (!reset) begin
      hvp_partition(waits_for_room ? 2 : int'(waits_for_turns), int'(rows), 2 ** QueueBits,
                    int'(Turns));
    end
    if (!reset && start && empty) hvp_event("product of an empty partition", 0);
  end

endmodule

bind engine observed_engine observed (
    .clock,
    .reset,
    .go,
    .copy,
    .invert,
    .edit,
    .restores,
    .editing,
    .preconditions,
    .state,
    .pass,
    .nodes(32'(nodes)),
    .starts_zero,
    .extrapolated,
    .has_previous,
    .dynamic_scaling,
    .step,
    .shift_rounding,
    .division_rounding,
    .hold,
    .finished,
    .iteration_made,
    .breakdown,
    .reached,
    .scalar_overflow,
    .replacements,
    .clamped
);
bind spmxv_partition observed_partition #(
    .QueueBits(QueueBits),
    .Turns(Nodes > DirectionAccesses || RowsInParallel < 3)
) observed (
    .clock,
    .reset,
    .start,
    .waits_for_turns,
    .waits_for_room,
    .empty(packages == '0),
    .rows(finished - taken)
);

`default_nettype wire
