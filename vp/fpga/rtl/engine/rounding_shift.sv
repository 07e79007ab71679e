// magnitude / 2^right, rounded: fixed::shift on the magnitude of a word (docs/fixed-point.md).
//
// A product is aligned in three ranks: shifted by eights, by ones, and rounded. What was shifted
// out is kept as the highest of its bits and whether any other was set. A quotient that is too long
// becomes all ones, as does any magnitude but zero where `beyond` says that it had to be shifted to
// the left further than there is room: OutBits have to be so many that all ones are beyond every
// word after the sum that follows.
`default_nettype none

module rounding_shift
  import engine_types::*;
#(
    parameter int InBits = 48,
    parameter int OutBits = 18,
    parameter int RightBits = 6
) (
    input wire clock,
    input wire rounding_t rounding,     // still while a pass runs, like `right` and `beyond`
    input wire [RightBits-1:0] right,
    input wire beyond,
    input wire [InBits-1:0] magnitude,
    output logic [OutBits-1:0] word     // three clocks later
);

  // One bit more: what is shifted out last.
  localparam int Wide = InBits + 1;
  wire [Wide-1:0] extended = {magnitude, 1'b0};
  wire [RightBits-1:0] eights = {right[RightBits-1:3], 3'b000};

  logic [Wide-1:0] coarse, fine;
  logic coarse_rest, fine_rest, coarse_beyond, fine_beyond;
  wire [Wide-1:0] below_eights = ~({Wide{1'b1}} << eights);
  wire [Wide-1:0] below_ones = ~({Wide{1'b1}} << right[2:0]);

  always_ff @(posedge clock) begin
    coarse <= extended >> eights;
    coarse_rest <= |(extended & below_eights);
    coarse_beyond <= beyond && magnitude != '0;
    fine <= coarse >> right[2:0];
    fine_rest <= coarse_rest || |(coarse & below_ones);
    fine_beyond <= coarse_beyond;
  end

  wire half = fine[0];
  wire odd = fine[1];
  wire up = rounding == NearestUp ? half : rounding == NearestEven && half && (fine_rest || odd);
  wire [OutBits-1:0] kept = fine[OutBits:1];
  wire too_long = fine_beyond || |fine[Wide-1:OutBits+1];

  always_ff @(posedge clock) begin
    // All ones are beyond every word, with the one and without it.
    word <= (too_long || &kept) ? '1 : kept + OutBits'(up);
  end

endmodule

`default_nettype wire
