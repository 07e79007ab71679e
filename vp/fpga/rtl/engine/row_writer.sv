// A component of a row that the collector has taken: its exact sum becomes a word of q, rounded and
// clamped once (engine::VectorUnit::write_back).
//
// Rank 0 is the collector's register. The word is there at rank 2, at which it enters the lane, and
// again at rank Written, before the edge that writes it.
`default_nettype none

module row_writer
  import engine_types::*;
#(
    parameter int SumBits = 38,
    parameter int ProductBits = 32,
    parameter int ProductShift = 0,  // bits of the sum that q drops
    parameter int Written = 9
) (
    input wire clock,
    input wire rounding_t rounding,
    input wire zero,  // the product with an x that counts as zero
    input wire signed [SumBits-1:0] sum,
    output logic signed [ProductBits-1:0] q,
    output logic clamped,
    output wire signed [ProductBits-1:0] q_written
);

  localparam int Q = ProductBits;
  wire [SumBits-1:0] size = zero ? '0 : sum[SumBits-1] ? -sum : sum;
  logic [SumBits-1:0] rounded, rounded1;
  logic negative1;
  if (ProductShift == 0) begin : g_exact
    assign rounded = size;
    wire unused = &{1'b0, rounding};
  end else begin : g_rounded
    wire half = size[ProductShift-1];
    wire odd = size[ProductShift];
    wire rest = |(size & ~({SumBits{1'b1}} << (ProductShift - 1)));
    wire up = rounding == NearestUp ? half : rounding == NearestEven && half && (rest || odd);
    assign rounded = (size >> ProductShift) + SumBits'(up);
  end

  wire too_long = |rounded1[SumBits-1:Q-1];
  wire [Q-2:0] kept = too_long ? '1 : rounded1[Q-2:0];
  logic signed [Q-1:0] late[3:Written];
  always_ff @(posedge clock) begin
    rounded1 <= rounded;
    negative1 <= sum[SumBits-1];
    q <= negative1 ? -$signed({1'b0, kept}) : $signed({1'b0, kept});
    clamped <= too_long;
    late[3] <= q;
    for (int i = 4; i <= Written; ++i) late[i] <= late[i-1];
  end
  assign q_written = late[Written];

endmodule

`default_nettype wire
