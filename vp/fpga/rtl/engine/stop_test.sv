// The stop test in integers: ||r|| <= t ||b||, as engine::Sequencer::reached() computes it in doubles,
//
//   fl(r.r) * 2^(-2 r_exponent)  <=  fl(fl(t^2) * fl(b.b)) * 2^(2 static_shift)
//
// with fl() the rounding to 53 bits, to nearest and ties to even. The host gives fl(t^2) as a
// mantissa and an exponent. All mantissas have their highest bit set, so that a comparison is one of
// exponents and then of mantissas.
//
// The right-hand side takes 18 clocks once a job, r.r takes nine at every residual: less than the
// pass behind it, at whose end the answer is asked for.
`default_nettype none

module stop_test #(
    parameter int SquareBits = 59,  // of both sums
    parameter int ExponentBits = 22
) (
    input wire clock,
    input wire reset,
    input wire [52:0] tolerance,                   // of fl(t^2)
    input wire signed [11:0] tolerance_exponent,
    input wire [4:0] static_shift,
    input wire take_rhs,                           // b.b is there
    input wire [SquareBits-1:0] rhs_squares,
    input wire take_residual,                      // r.r is there
    input wire [SquareBits-1:0] squares,
    input wire signed [ExponentBits-1:0] r_exponent,
    output logic reached
);

  localparam int E = ExponentBits;
  localparam int Bytes = SquareBits > 64 ? (SquareBits + 7) / 8 : 8;
  localparam int W = 8 * Bytes;
  localparam int Mantissa = 53;
  localparam int Digit = 8;  // bits of the multiplier a clock
  localparam int Digits = (Mantissa + Digit - 1) / Digit;

  typedef enum logic [3:0] {
    Wait,
    MeasureBytes,
    MeasureBits,
    AlignBytes,
    AlignBits,
    Halve,
    Round,
    Multiply,
    Accumulate,
    AlignProduct,
    HalveProduct,
    RoundProduct,
    Compare,
    Decide
  } state_t;
  state_t state;

  // ---- What is to be rounded: b.b, or r.r, which may come while the right-hand side is made.
  logic [W-1:0] value;
  logic of_rhs, waits;
  logic [SquareBits-1:0] waiting;
  logic signed [E-1:0] waiting_exponent, exponent;
  // Its length: how many bytes of zeros it begins with, and then how many bits.
  logic [3:0] bytes_left, bytes_now;
  logic [7:0] top_byte, byte_now;
  logic [2:0] bits_left, bits_now;
  always_comb begin
    bytes_left = '0;
    top_byte = '0;
    for (int i = 0; i < Bytes; ++i) begin
      if (|value[8*i+:8]) begin
        bytes_left = 4'(Bytes - 1 - i);
        top_byte = value[8*i+:8];
      end
    end
    bits_left = '0;
    for (int i = 0; i < 8; ++i) if (byte_now[i]) bits_left = 3'(7 - i);
  end

  // The highest 53 bits of a magnitude whose highest bit is set, and what becomes of the others.
  wire [Mantissa-1:0] kept = value[W-1-:Mantissa];
  wire half = value[W-1-Mantissa];
  wire rest = |value[W-2-Mantissa:0];
  logic up;
  wire [Mantissa:0] rounded = {1'b0, kept} + (Mantissa + 1)'(up);

  // ---- The product with t^2, eight bits of it a clock, and its rounding.
  logic [2*Mantissa+Digit-1:0] product;
  logic [Digits*Digit-1:0] factor;
  logic [Mantissa-1:0] mantissa;
  logic [3:0] count;
  logic [Mantissa+Digit-1:0] partial;
  logic long;
  wire [Mantissa:0] product_rounded = {1'b0, product[2*Mantissa-1-:Mantissa]} +
                                      (Mantissa + 1)'(up);

  // ---- The limit.
  logic limit_zero;
  logic [Mantissa-1:0] limit;
  logic signed [E-1:0] limit_exponent;
  logic zero;
  logic exponent_below, exponent_equal, mantissa_within;

  always_ff @(posedge clock) begin
    case (state)
      Wait:
      if (waits) begin
        value <= W'(waiting);
        exponent <= waiting_exponent;
        of_rhs <= 1'b0;
        waits <= 1'b0;
        state <= MeasureBytes;
      end
      MeasureBytes: begin
        bytes_now <= bytes_left;
        byte_now <= top_byte;
        zero <= value == '0;
        exponent <= exponent + E'(W - Mantissa);
        state <= MeasureBits;
      end
      MeasureBits: begin
        bits_now <= bits_left;
        state <= AlignBytes;
      end
      AlignBytes: begin
        value <= value << {bytes_now, 3'b000};
        exponent <= exponent - E'({bytes_now, bits_now});
        state <= AlignBits;
      end
      AlignBits: begin
        value <= value << bits_now;
        state <= Halve;
      end
      Halve: begin
        up <= half && (rest || kept[0]);
        state <= Round;
      end
      Round: begin
        mantissa <= rounded[Mantissa] ? {1'b1, {(Mantissa - 1) {1'b0}}} : rounded[Mantissa-1:0];
        exponent <= exponent + E'(rounded[Mantissa]);
        product <= '0;
        partial <= '0;
        factor <= (Digits * Digit)'(tolerance);
        count <= 4'(Digits - 1);
        state <= of_rhs ? Multiply : Compare;
      end
      Multiply: begin
        partial <= mantissa * factor[Digits*Digit-1-:Digit];
        product <= (product << Digit) + (2 * Mantissa + Digit)'(partial);
        factor <= factor << Digit;
        count <= count - 1'b1;
        if (count == '0) state <= Accumulate;
      end
      Accumulate: begin
        product <= (product << Digit) + (2 * Mantissa + Digit)'(partial);
        state <= AlignProduct;
      end
      AlignProduct: begin
        long <= product[2*Mantissa-1];
        if (!product[2*Mantissa-1]) product <= product << 1;
        exponent <= exponent + E'(tolerance_exponent) + (E'(static_shift) <<< 1);
        state <= HalveProduct;
      end
      HalveProduct: begin
        up <= product[Mantissa-1] && (|product[Mantissa-2:0] || product[Mantissa]);
        exponent <= exponent + E'(Mantissa - 1) + E'(long);
        state <= RoundProduct;
      end
      RoundProduct: begin
        limit <= product_rounded[Mantissa] ? {1'b1, {(Mantissa - 1) {1'b0}}}
                                           : product_rounded[Mantissa-1:0];
        limit_exponent <= exponent + E'(product_rounded[Mantissa]);
        limit_zero <= zero;
        state <= Wait;
      end
      Compare: begin
        exponent_below <= exponent < limit_exponent;
        exponent_equal <= exponent == limit_exponent;
        mantissa_within <= mantissa <= limit;
        state <= Decide;
      end
      Decide: begin
        reached <= zero || (!limit_zero && (exponent_below || (exponent_equal && mantissa_within)));
        state <= Wait;
      end
      default: state <= Wait;
    endcase
    if (take_rhs) begin
      value <= W'(rhs_squares);
      exponent <= '0;
      of_rhs <= 1'b1;
      state <= MeasureBytes;
    end
    if (take_residual) begin
      waiting <= squares;
      waiting_exponent <= -(r_exponent <<< 1);
      waits <= 1'b1;
      reached <= squares == '0;  // an engine without nodes is asked before there is an answer
    end
    if (reset) begin
      state <= Wait;
      waits <= 1'b0;
    end
  end
  wire unused = &{1'b0, product[2*Mantissa+Digit-1:2*Mantissa]};

endmodule

`default_nettype wire
