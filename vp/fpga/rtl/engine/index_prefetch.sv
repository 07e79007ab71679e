// The index memory of a partition and the words that are read ahead of it, so that what a package
// needs to enter is in registers and no memory's output decides about the next address.
//
// The first word is there three clocks behind a reset, a write or the editor; from then on another
// one with every clock in which one is taken. Behind the last package comes the first one of the
// next product.
`default_nettype none

module index_prefetch #(
    parameter int Bits = 53,
    parameter int PackageBits = 11
) (
    input wire clock,
    input wire reset,
    // The host's port.
    input wire write,
    input wire [PackageBits-1:0] write_package,
    input wire [Bits-1:0] write_word,
    input wire [PackageBits:0] packages,
    input wire restarts,  // their number changes
    // The editor's address, in place of the next one; its word is there with the next edge.
    input wire pauses,
    input wire [PackageBits-1:0] paused_package,
    // What the memory shows; how many turns the banks of d need for it is kept beside it.
    output logic [Bits-1:0] read,
    input wire [1:0] read_last_turn,
    // The package that enters next.
    input wire takes,
    output wire there,
    output wire [Bits-1:0] word,
    output wire [1:0] last_turn,
    output wire ends  // it is the last one
);

  // A word that is read while it is written is not used: a block RAM needs no logic for that.
  (* no_rw_check *) logic [Bits-1:0] cells[2**PackageBits];
  logic read_valid, read_ends;
  logic [PackageBits-1:0] fetched;

  // Two registers: the first one's word is taken, the second one's waits.
  logic [1:0] full;
  logic [Bits+2:0] first, second;
  wire [Bits+2:0] arriving = {read_ends, read_last_turn, read};
  wire filled = full[1] || (full[0] && read_valid);
  wire empties = reset || write || restarts;
  wire fetches = !pauses && packages != '0 && (!filled || takes);
  wire wraps = (PackageBits + 1)'(fetched) + 1'b1 == packages;
  wire moves = takes || !full[0];

  always_ff @(posedge clock) begin
    if (write) cells[write_package] <= write_word;
    read <= cells[pauses?paused_package : fetched];
    read_valid <= fetches;
    read_ends <= wraps;
    if (fetches) fetched <= wraps ? '0 : fetched + 1'b1;
    if (moves) first <= full[1] ? second : arriving;
    if (read_valid) second <= arriving;
    full[0] <= full[1] || read_valid || !moves;
    full[1] <= full[0] && !takes && (full[1] || read_valid);
    if (empties) begin
      fetched <= '0;
      read_valid <= 1'b0;
      full <= '0;
    end
  end
  assign {ends, last_turn, word} = first;
  assign there = full[0];

endmodule

`default_nettype wire
