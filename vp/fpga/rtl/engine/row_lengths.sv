// The rows of P^-1 by the bits of what their magnitudes add up to, so that no order looks at all of
// them: z = P^-1 r drops as many bits as the longest row has (fixed::ReferencePreconditioner).
`default_nettype none

module row_lengths #(
    parameter int CountBits = 12,  // of all rows
    parameter int Lengths = 32,
    localparam int LengthBits = $clog2(Lengths)
) (
    input wire clock,
    input wire clear,
    input wire leaves,  // a row of that length is no more
    input wire enters,  // or there is one more
    input wire [LengthBits-1:0] length,
    output logic [5:0] shift  // the longest row's, two clocks later
);

  logic [CountBits-1:0] rows[Lengths];
  logic [Lengths-1:0] some;  // there are rows of this length
  wire [CountBits-1:0] count = some[length] ? rows[length] : '0;
  wire [CountBits-1:0] count_now = leaves ? count - 1'b1 : count + 1'b1;
  always_ff @(posedge clock) begin
    if (leaves || enters) begin
      rows[length] <= count_now;
      some[length] <= count_now != '0;
    end
    if (clear) some <= '0;
    shift <= '0;
    for (int i = 0; i < Lengths; ++i) if (some[i]) shift <= 6'(i);
  end

endmodule

`default_nettype wire
