// One component of a lane: its row of z = P^-1 r with the inverse 3 x 3 blocks of the diagonal, and
// z * r (engine::VectorLanes).
//
// Ranks are those of preconditioner_lane.sv: 11 r arrives, 12 |r| and the row of P^-1, 13 their products
// in four parts each, 14 the parts of all three summed, 15 their sum, 18 z, 21 z * r. Words of P^-1
// have a sign and a magnitude. No z is beyond its word, since no row of P^-1 adds up to more than the
// bits that z drops, unless a bit of it has flipped: then it is clamped.
`default_nettype none

module block_preconditioner_lane
  import engine_types::*;
#(
    parameter int Bits = WideBits,
    parameter int Component = 0
) (
    input wire clock,
    input wire rounding_t rounding,
    input wire [5:0] shift,                   // bits that z drops; still while a pass runs, as `rounding` is
    input wire [2:0][Bits-1:0] r,             // rank 11: of the node
    input wire [2:0][Bits-1:0] inverse,       // rank 12
    output wire signed [Bits-1:0] z,          // rank 18
    output wire [Bits-2:0] z_size,
    output wire signed [2*Bits-2:0] z_r       // rank 21
);

  localparam int Low = Bits / 2;
  localparam int High = Bits - 1 - Low;
  localparam int PartBits = 2 * Low + 3;  // of six terms with a sign
  localparam int SumBits = 2 * Bits;

  function automatic logic [Bits-2:0] magnitude(input logic [Bits-1:0] word);
    return word[Bits-1] ? (Bits - 1)'(-word) : word[Bits-2:0];
  endfunction
  function automatic logic signed [PartBits-1:0] signed_of(input logic negative,
                                                           input logic [PartBits-2:0] size);
    return negative ? -PartBits'(size) : PartBits'(size);
  endfunction

  logic [2:0][Bits-2:0] size12;
  logic [2:0] r_negative12, negative13;
  logic [2:0][2*Low-1:0] low13;
  logic [2:0][Low+High-1:0] cross_a13, cross_b13;
  logic [2:0][2*High-1:0] high13;
  always_ff @(posedge clock) begin
    for (int k = 0; k < 3; ++k) begin
      size12[k] <= magnitude(r[k]);
      r_negative12[k] <= r[k][Bits-1];
      negative13[k] <= r_negative12[k] ^ inverse[k][Bits-1];
      low13[k] <= size12[k][Low-1:0] * inverse[k][Low-1:0];
      cross_a13[k] <= size12[k][Bits-2:Low] * inverse[k][Low-1:0];
      cross_b13[k] <= size12[k][Low-1:0] * inverse[k][Bits-2:Low];
      high13[k] <= size12[k][Bits-2:Low] * inverse[k][Bits-2:Low];
    end
  end

  logic signed [PartBits-1:0] low, middle, high, low14, middle14, high14;
  logic signed [SumBits-1:0] sum15;
  always_comb begin
    low = '0;
    middle = '0;
    high = '0;
    for (int k = 0; k < 3; ++k) begin
      low = low + signed_of(negative13[k], (PartBits - 1)'(low13[k]));
      middle = middle + signed_of(negative13[k], (PartBits - 1)'(cross_a13[k])) +
               signed_of(negative13[k], (PartBits - 1)'(cross_b13[k]));
      high = high + signed_of(negative13[k], (PartBits - 1)'(high13[k]));
    end
  end
  always_ff @(posedge clock) begin
    low14 <= low;
    middle14 <= middle;
    high14 <= high;
    sum15 <= (SumBits'(high14) <<< 2 * Low) + (SumBits'(middle14) <<< Low) + SumBits'(low14);
  end

  // What waits beside them: |r| of this component, and the signs.
  logic [Bits-2:0] size[13:18];
  logic [18:13] r_negative;
  logic [18:16] negative;
  logic [21:19] z_r_negative;
  always_ff @(posedge clock) begin
    size[13] <= size12[Component];
    for (int i = 14; i <= 18; ++i) size[i] <= size[i-1];
    r_negative <= {r_negative[17:13], r_negative12[Component]};
    negative <= {negative[17:16], sum15[SumBits-1]};
    z_r_negative <= {z_r_negative[20:19], negative[18] ^ r_negative[18]};
  end

  wire [SumBits-1:0] sum_size = sum15[SumBits-1] ? -sum15 : sum15;
  wire [Bits-1:0] rounded;
  rounding_shift #(
      .InBits(SumBits - 1),
      .OutBits(Bits)
  ) dropped (
      .clock,
      .rounding,
      .right(shift),
      .beyond(1'b0),
      .magnitude(sum_size[SumBits-2:0]),
      .word(rounded)
  );
  assign z_size = rounded[Bits-1] ? '1 : rounded[Bits-2:0];
  assign z = negative[18] ? -{1'b0, z_size} : {1'b0, z_size};
  wire [2*Bits-3:0] z_r_size;
  wide_multiplier #(
      .Bits(Bits - 1)
  ) multiplied (
      .clock,
      .a(z_size),
      .b(size[18]),
      .product(z_r_size)
  );
  assign z_r = z_r_negative[21] ? -{1'b0, z_r_size} : {1'b0, z_r_size};
  wire unused = &{1'b0, sum_size[SumBits-1]};

endmodule

`default_nettype wire
