// The nodes of which P^-1 is made, one after the other, and their clocks (engine::MatrixEditor): all
// nodes, whose rows the matrix editor looks up, or the one that it has changed.
//
// A node takes NodeClocks, in which its row is looked up and its words are made. An order for all
// nodes takes PhaseClocks more, one for a node OneMore.
`default_nettype none

module inverse_order #(
    parameter int NodeBits = 10,
    parameter int PhaseClocks = 20,
    parameter int NodeClocks = 204,
    parameter int OneMore = 0
) (
    input wire clock,
    input wire reset,
    input wire [NodeBits:0] nodes,
    input wire all,                        // an order for all nodes
    input wire one,                        // or for one, whose row is there
    input wire [NodeBits-1:0] edited_node,
    output logic busy,
    // Of an order for all: the editor looks up the row of `node`.
    output logic of_all,
    output logic look,
    output logic [NodeBits-1:0] node,
    input wire looked,
    // A node's row is there with the next clock; and its words were the last to be made.
    output wire begins,
    input wire made
);

  localparam int ClockBits = $clog2(NodeClocks + PhaseClocks + OneMore + 1);
  localparam int LookUp = 3;  // clocks for which the node's number holds still before

  typedef enum logic [2:0] {
    Wait,
    HoldNode,
    Look,
    Make,
    Rest,
    Drain
  } state_t;
  state_t state;
  logic [ClockBits-1:0] clocks;  // that are left of the node, or until the pipelines are empty
  logic [NodeBits:0] left;       // nodes
  logic [1:0] held;
  assign begins = one || (state == Look && looked && !all);

  always_ff @(posedge clock) begin
    look <= 1'b0;
    if (clocks != '0) clocks <= clocks - 1'b1;
    case (state)
      HoldNode: begin
        held <= held - 1'b1;
        if (held == '0) begin
          look <= 1'b1;
          state <= Look;
        end
      end
      Look: if (looked) state <= Make;
      Make: if (made) state <= Rest;
      // The node's clocks are over.
      Rest: if (clocks == ClockBits'(1)) begin
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
      Drain: if (clocks == ClockBits'(1)) begin
        busy <= 1'b0;
        state <= Wait;
      end
      default: ;
    endcase
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
      clocks <= ClockBits'(NodeClocks + OneMore);
      state <= Make;
    end
    if (reset) begin
      busy <= 1'b0;
      look <= 1'b0;
      state <= Wait;
    end
  end

  task automatic begin_node();
    clocks <= ClockBits'(NodeClocks);
    held <= 2'(LookUp);
    state <= HoldNode;
  endtask

`ifndef SYNTHESIS
  always_ff @(posedge clock) begin
    if (busy && !reset && state != Rest && state != Drain && clocks == ClockBits'(1)) begin
      $error("a node's words of the inverse are not made in time");
    end
  end
`endif

endmodule

`default_nettype wire
