// P^-1 of Jacobi's preconditioner (fixed::ReferencePreconditioner): of each row of the matrix
// 2^(MatrixBits + InverseBits) / diagonal, rounded to nearest, at most the largest word; zero where
// the diagonal is not positive. Of all nodes, whose rows the matrix editor looks up, or of the node
// that it has changed (engine::MatrixEditor).
//
// A node takes the clocks of three divisions, in which the serial divider makes its three words; the
// first of them pass while the node's row is looked up. An order for all nodes takes PhaseClocks more.
//
// z = P^-1 r drops as many bits as the longest word of P^-1 has: rows are counted by the length of
// their word, so that no order looks at all of them.
`default_nettype none

module inverse_maker
  import engine_types::*;
#(
    parameter int MatrixBits = 12,
    parameter int NodeBits = 10,
    parameter int PhaseClocks = 20,
    parameter int DivisionClocks = 68
) (
    input wire clock,
    input wire reset,
    input wire [NodeBits:0] nodes,
    input wire all,                        // an order for all nodes
    input wire one,                        // or for one, whose diagonal is there
    input wire [NodeBits-1:0] edited_node,
    output logic busy,
    // Of an order for all: the editor looks up the diagonal of `node`.
    output wire inverts_all,
    output logic look,
    output logic [NodeBits-1:0] node,
    input wire looked,
    input wire [2:0][MatrixBits-1:0] diagonal,
    // The memory of P^-1, whose words come two clocks behind the address.
    output logic [1:0] component,
    output logic write,
    output logic [WideBits-2:0] word,
    input wire [WideBits-2:0] old_word,
    output logic [5:0] shift
);

  localparam int Steps = MatrixBits + InverseBits + 1;  // bits of the numerator
  localparam int StepBits = $clog2(Steps);
  localparam int NodeClocks = 3 * DivisionClocks;
  localparam int ClockBits = $clog2(NodeClocks + 1);
  localparam int CountBits = NodeBits + 2;  // of three rows a node
  localparam int LookUp = 3;                // clocks for which the node's number holds still before

  typedef enum logic [3:0] {
    Wait,
    HoldNode,
    Look,
    Load,
    Step,
    Round,
    Write,
    CountOld,
    CountNew,
    Rest,
    Drain
  } state_t;
  state_t state;

  logic of_all;
  logic [ClockBits-1:0] clocks;  // that are left of the node, or until the pipelines are empty
  logic [NodeBits:0] left;       // nodes
  assign inverts_all = busy && of_all;

  // ---- The divider: a bit of 2^(Steps - 1) a clock.
  logic [MatrixBits-1:0] divisor;
  logic [MatrixBits-1:0] rest;
  logic [Steps-1:0] quotient;
  logic [StepBits-1:0] steps;
  wire [MatrixBits-1:0] dividend =
      {rest[MatrixBits-2:0], steps == StepBits'(Steps - 1)};
  wire fits = dividend >= divisor;
  wire positive = !divisor[MatrixBits-1] && divisor != '0;
  wire up = {rest, 1'b0} >= {1'b0, divisor};
  logic too_long;
  if (Steps > WideBits - 1) begin : g_clamped
    assign too_long = |quotient[Steps-1:WideBits-1];
  end else begin : g_short
    assign too_long = 1'b0;
  end

  // ---- Rows by the length of their word.
  logic [CountBits-1:0] rows[WideBits];
  logic [WideBits-1:0] some;  // there are rows of this length
  function automatic logic [4:0] length(input logic [WideBits-2:0] value);
    length = '0;
    for (int i = 0; i < WideBits - 1; ++i) if (value[i]) length = 5'(i + 1);
  endfunction
  logic [4:0] old_length, new_length;
  wire [4:0] counted_length = state == CountOld ? old_length : new_length;
  wire [CountBits-1:0] count = some[counted_length] ? rows[counted_length] : '0;
  wire [CountBits-1:0] count_now = state == CountOld ? count - 1'b1 : count + 1'b1;
  wire counts = state == CountOld || state == CountNew;
  always_ff @(posedge clock) begin
    if (counts) begin
      rows[counted_length] <= count_now;
      some[counted_length] <= count_now != '0;
    end
    if (all) some <= '0;
    shift <= '0;
    for (int i = 0; i < WideBits; ++i) if (some[i]) shift <= 6'(i);
  end

  wire last_component = component == 2'd2;
  always_ff @(posedge clock) begin
    look <= 1'b0;
    write <= 1'b0;
    if (clocks != '0) clocks <= clocks - 1'b1;
    case (state)
      Wait: ;
      HoldNode: begin
        steps <= steps - 1'b1;
        if (steps == '0) begin
          look <= 1'b1;
          state <= Look;
        end
      end
      Look: if (looked) state <= Load;
      Load: begin
        divisor <= diagonal[component];
        rest <= '0;
        quotient <= '0;
        steps <= StepBits'(Steps - 1);
        state <= Step;
      end
      Step: begin
        rest <= fits ? dividend - divisor : dividend;
        quotient <= {quotient[Steps-2:0], fits};
        steps <= steps - 1'b1;
        if (steps == '0) state <= Round;
      end
      Round: begin
        old_length <= length(old_word);
        quotient <= quotient + Steps'(up);
        state <= Write;
      end
      Write: begin
        word <= !positive ? '0 : too_long ? '1 : (WideBits - 1)'(quotient);
        write <= 1'b1;
        state <= of_all ? CountNew : CountOld;
      end
      CountOld: state <= CountNew;
      CountNew: begin
        component <= component + 1'b1;
        state <= last_component ? Rest : Load;
      end
      Rest: ;
      Drain: if (clocks == ClockBits'(1)) begin
        busy <= 1'b0;
        state <= Wait;
      end
      default: state <= Wait;
    endcase
    // The node's clocks are over.
    if (state == Rest && clocks == ClockBits'(1)) begin
      if (!of_all) begin
        busy <= 1'b0;
        state <= Wait;
      end else if (left == (NodeBits + 1)'(1)) begin
        clocks <= ClockBits'(PhaseClocks);
        state <= Drain;
      end else begin
        left <= left - 1'b1;
        node <= node + 1'b1;
        begin_node();
      end
    end
    if (all) begin
      busy <= 1'b1;
      of_all <= 1'b1;
      node <= '0;
      left <= nodes;
      begin_node();
      if (nodes == '0) begin
        clocks <= ClockBits'(1);
        state <= Drain;
      end
    end
    if (one) begin
      busy <= 1'b1;
      of_all <= 1'b0;
      node <= edited_node;
      begin_node();
      state <= Load;
    end
    if (reset) begin
      busy <= 1'b0;
      look <= 1'b0;
      write <= 1'b0;
      state <= Wait;
    end
  end

  task automatic begin_node();
    clocks <= ClockBits'(NodeClocks);
    component <= '0;
    steps <= StepBits'(LookUp);
    state <= HoldNode;
  endtask

  // The length of the word that is written: `word` is there with the state behind Write.
  assign new_length = length(word);

`ifndef SYNTHESIS
  always_ff @(posedge clock) begin
    if (busy && !reset && state != Rest && state != Drain && clocks == ClockBits'(1)) begin
      $error("a node's words of the inverse diagonal are not made in time");
    end
  end
`endif

endmodule

`default_nettype wire
