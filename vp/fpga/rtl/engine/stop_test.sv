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
  // Where they round up to a power of two, the lower bits become zeros and the highest one stays.
  logic up, carries;
  wire [Mantissa-1:0] rounded = kept + Mantissa'(up);

  // ---- The product with t^2, eight bits of it a clock from the lowest on, and its rounding. A digit
  // is multiplied by parts of the mantissa that fit a multiplier; those that do not overlap are one
  // number, so that two are added.
  localparam int Part = 18;
  localparam int Rest = Mantissa - 2 * Part;
  logic [Mantissa+Digits*Digit-1:0] product;
  logic [Digits*Digit-1:0] factor;
  wire [Digit-1:0] digit = factor[Digit-1:0];
  logic [Mantissa-1:0] mantissa;
  logic [3:0] count;
  logic [Part+Digit-1:0] low, middle;
  logic [Rest+Digit-1:0] high;
  wire [Mantissa+Digit-1:0] outer = {high, {(Part - Digit) {1'b0}}, low};
  wire [Mantissa+Digit-1:0] inner = {{Rest{1'b0}}, middle, {Part{1'b0}}};
  wire [Mantissa+Digits*Digit-1:0] summed = {
    (Mantissa + Digit)'(product[Digits*Digit+:Mantissa]) + outer + inner,
    product[Digits*Digit-1:Digit]
  };
  logic long;
  wire [Mantissa-1:0] product_kept = product[2*Mantissa-1-:Mantissa];
  wire [Mantissa-1:0] product_rounded = product_kept + Mantissa'(up);

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
        carries <= &kept;
        state <= Round;
      end
      Round: begin
        mantissa <= {1'b1, rounded[Mantissa-2:0]};
        exponent <= exponent + E'(up && carries);
        product <= '0;
        low <= '0;
        middle <= '0;
        high <= '0;
        factor <= (Digits * Digit)'(tolerance);
        count <= 4'(Digits - 1);
        state <= of_rhs ? Multiply : Compare;
      end
      Multiply: begin
        low <= mantissa[0+:Part] * digit;
        middle <= mantissa[Part+:Part] * digit;
        high <= mantissa[2*Part+:Rest] * digit;
        product <= summed;
        factor <= factor >> Digit;
        count <= count - 1'b1;
        if (count == '0) state <= Accumulate;
      end
      Accumulate: begin
        product <= summed;
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
        carries <= &product_kept;
        exponent <= exponent + E'(Mantissa - 1) + E'(long);
        state <= RoundProduct;
      end
      RoundProduct: begin
        limit <= {1'b1, product_rounded[Mantissa-2:0]};
        limit_exponent <= exponent + E'(up && carries);
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
  wire unused = &{1'b0, product[Mantissa+Digits*Digit-1:2*Mantissa], rounded[Mantissa-1],
                     product_rounded[Mantissa-1]};

endmodule

`default_nettype wire
