// One component of a lane: z = P^-1 r with the inverse diagonal, and z * r (engine::VectorLanes).
//
// Ranks go on from those of vector_lane.sv: 11 r arrives, 12 |r| and the word of P^-1, 15 their
// product, 18 z, 21 z * r. No z is beyond its word, since no word of P^-1 is longer than the bits that
// z drops, unless a bit of it has flipped: then it is clamped. No z * r is negative.
`default_nettype none

module preconditioner_lane
  import engine_types::*;
#(
    parameter int Bits = WideBits
) (
    input wire clock,
    input wire rounding_t rounding,
    input wire [5:0] shift,           // bits that z drops; still while a pass runs, as `rounding` is
    input wire signed [Bits-1:0] r,   // rank 11
    input wire [Bits-2:0] inverse,    // rank 12
    output wire signed [Bits-1:0] z,  // rank 18
    output wire [Bits-2:0] z_size,
    output wire [2*Bits-3:0] z_r      // rank 21
);

  logic [Bits-2:0] size[12:18];
  logic [18:12] negative;
  wire [Bits-1:0] r_size = r[Bits-1] ? -r : r;
  always_ff @(posedge clock) begin
    size[12] <= r_size[Bits-2:0];
    for (int i = 13; i <= 18; ++i) size[i] <= size[i-1];
    negative <= {negative[17:12], r[Bits-1]};
  end

  wire [2*Bits-3:0] product;
  wire [Bits-1:0] rounded;
  wide_multiplier #(
      .Bits(Bits - 1)
  ) preconditioned (
      .clock,
      .a(size[12]),
      .b(inverse),
      .product
  );
  rounding_shift #(
      .InBits(2 * Bits - 2),
      .OutBits(Bits)
  ) dropped (
      .clock,
      .rounding,
      .right(shift),
      .beyond(1'b0),
      .magnitude(product),
      .word(rounded)
  );
  assign z_size = rounded[Bits-1] ? '1 : rounded[Bits-2:0];
  assign z = negative[18] ? -{1'b0, z_size} : {1'b0, z_size};
  wide_multiplier #(
      .Bits(Bits - 1)
  ) multiplied (
      .clock,
      .a(z_size),
      .b(size[18]),
      .product(z_r)
  );
  wire unused = &{1'b0, r_size[Bits-1]};

endmodule

`default_nettype wire
