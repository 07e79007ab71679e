// How the banks of d serve a package: of each component a bank has the package's nodes in order,
// `Accesses` of them a clock, its turn. A node is in bank node mod Banks.
//
// A package's padding repeats the node before it, whose word serves for both
// (engine::Layout::clocks_of).
`default_nettype none

module bank_reads #(
    parameter int Package = 8,
    parameter int NodeBits = 10,
    parameter int Banks = 1,
    parameter int Accesses = 4,
    localparam int Nodes = Package % 3 == 0 ? Package / 3 : (Package + 1) / 3 + 1
) (
    input wire [1:0] phase,
    input wire [Nodes-1:0][NodeBits-1:0] node,
    output logic [2:0][Nodes-1:0] reads,        // whether a component is among the columns
    output logic [2:0][Nodes-1:0][2:0] number,  // of the read among those of its bank
    output logic [1:0] last_turn
);

  localparam int TurnShift = $clog2(Accesses);
  // The bits of a node that are its bank.
  localparam logic [NodeBits-1:0] BankMask = NodeBits'(Banks - 1);

  always_comb begin
    last_turn = '0;
    for (int k = 0; k < 3; ++k) begin
      automatic logic [Nodes-1:0] counts = '0;  // nodes that are read for themselves
      automatic logic [2:0] previous = '0;      // the number of the node before
      for (int n = 0; n < Nodes; ++n) begin
        automatic logic [2:0] here = '0;
        reads[k][n] = 3 * n + k >= int'(phase) && 3 * n + k < int'(phase) + Package;
        for (int m = 0; m < n; ++m) begin
          if (counts[m] && ((node[m] ^ node[n]) & BankMask) == '0) here = here + 1'b1;
        end
        counts[n] = reads[k][n];
        if (n > 0 && node[n] == node[n>0?n-1 : 0] && reads[k][n>0?n-1 : 0]) begin
          here = previous;
          counts[n] = 1'b0;
        end
        number[k][n] = here;
        previous = here;
        if (reads[k][n] && 2'(here >> TurnShift) > last_turn) last_turn = 2'(here >> TurnShift);
      end
    end
  end

endmodule

`default_nettype wire
