// P^-1 of Jacobi's preconditioner (fixed::ReferencePreconditioner): of each row of the matrix
// 2^(MatrixBits + InverseBits) / diagonal, rounded to nearest, at most the largest word; zero where
// the diagonal is not positive.
//
// A node takes the clocks of three divisions, in which the serial divider makes its three words; the
// first of them pass while the node's row is looked up (inverse_order.sv).
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
    input wire all,
    input wire one,
    input wire [NodeBits-1:0] edited_node,
    output wire busy,
    output wire inverts_all,
    output wire look,
    output wire [NodeBits-1:0] node,
    input wire looked,
    input wire [2:0][MatrixBits-1:0] diagonal,
    // The memory of P^-1, whose words come two clocks behind the address.
    output logic [1:0] component,
    output logic write,
    output logic [WideBits-2:0] word,
    input wire [WideBits-2:0] old_word,
    output wire [5:0] shift
);

  localparam int Steps = MatrixBits + InverseBits + 1;  // bits of the numerator
  localparam int StepBits = $clog2(Steps);

  typedef enum logic [2:0] {
    Wait,
    Load,
    Step,
    Round,
    Write,
    CountOld,
    CountNew
  } state_t;
  state_t state;
  wire last_component = component == 2'd2;
  wire begins, of_all;
  inverse_order #(
      .NodeBits(NodeBits),
      .PhaseClocks(PhaseClocks),
      .NodeClocks(3 * DivisionClocks)
  ) order (
      .clock,
      .reset,
      .nodes,
      .all,
      .one,
      .edited_node,
      .busy,
      .of_all,
      .look,
      .node,
      .looked,
      .begins,
      .made(state == CountNew && last_component)
  );
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

  // ---- Rows by the length of their word: `word` is there with the state behind Write.
  function automatic logic [4:0] length(input logic [WideBits-2:0] value);
    length = '0;
    for (int i = 0; i < WideBits - 1; ++i) if (value[i]) length = 5'(i + 1);
  endfunction
  logic [4:0] old_length;
  row_lengths #(
      .CountBits(NodeBits + 2),
      .Lengths(WideBits)
  ) lengths (
      .clock,
      .clear(all),
      .leaves(state == CountOld),
      .enters(state == CountNew),
      .length(state == CountOld ? old_length : length(word)),
      .shift
  );

  always_ff @(posedge clock) begin
    write <= 1'b0;
    case (state)
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
        state <= last_component ? Wait : Load;
      end
      default: ;
    endcase
    if (begins) begin
      component <= '0;
      state <= Load;
    end
    if (all) state <= Wait;
    if (reset) begin
      write <= 1'b0;
      state <= Wait;
    end
  end

endmodule

`default_nettype wire
