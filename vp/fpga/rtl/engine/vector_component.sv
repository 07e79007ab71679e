// A component of a lane with its memories: the words that are read, what the lane makes of them and
// of a row's sum, and what is written. Ranks are those of vector_lane.sv; words wait from rank 11 to
// the one before the edge that writes them, PhaseClocks - 5.
`default_nettype none

module vector_component
  import engine_types::*;
#(
    parameter int VectorBits = 16,
    parameter int ProductBits = 32,
    parameter int CoefficientBits = 16,
    parameter int StaticBits = 4,
    parameter int ProductShift = 0,
    parameter int SumBits = 38,
    parameter int AddressBits = 9,
    parameter int PhaseClocks = 20,
    localparam int DifferenceBits =
        difference_bits(VectorBits, StaticBits, ProductBits, ProductShift)
) (
    input wire clock,
    // Still while a pass runs.
    input wire pass_t pass,
    input wire zero,
    input wire exchange,
    input wire alone,
    input wire rounding_t rounding,
    input wire [StaticBits-1:0] static_shift,
    input wire [CoefficientBits-2:0] coefficient,
    input wire [5:0] right_d,
    input wire [5:0] right_q,
    input wire [5:0] right_r,
    input wire beyond_d,
    input wire beyond_q,
    input wire beyond_r,
    // The memories.
    input wire [AddressBits-1:0] read_address,
    input wire [AddressBits-1:0] b_address,
    input wire written,  // the group's words are written with the next edge, where the pass does so
    input wire [AddressBits-1:0] written_address,
    input wire previous_write,
    input wire [AddressBits-1:0] previous_address,
    input wire q_write,
    input wire [AddressBits-1:0] q_address,
    input wire host_x_write,
    input wire host_b_write,
    input wire [AddressBits-1:0] host_address,
    input wire [VectorBits-1:0] host_word,
    output wire [VectorBits-1:0] x,
    // Rank 2: of the copies of d, or the word at a row's own node; a row's sum is two ranks earlier.
    input wire [VectorBits-1:0] d,
    input wire [SumBits-1:0] sum,
    // What the sums are made of, by rank.
    output wire [ProductBits-1:0] q2,
    output wire q_clamped2,
    output wire b_clamped3,
    output wire [DifferenceBits-1:0] difference4,
    output wire [ProductBits+VectorBits-1:0] q_d6,
    output wire [VectorBits-1:0] sum_word11,
    output wire [VectorBits-1:0] r_word11,
    output wire sum_clamped11,
    output wire r_clamped11,
    output wire [2*VectorBits-3:0] square14,
    output logic [VectorBits-1:0] direction_new  // with the edge that writes the others
);

  localparam int V = VectorBits;
  localparam int Q = ProductBits;
  localparam int Written = PhaseClocks - 5;
  localparam int RowWritten = PhaseClocks - 11;

  wire [V-1:0] r, b, previous, old_d11;
  wire [Q-1:0] q, q_written;
  wire [V-1:0] late_sum, late_r, late_d;
  wire clears = pass == Residual && zero;

  vector_bank #(
      .VectorBits(V),
      .ProductBits(Q),
      .AddressBits(AddressBits)
  ) bank (
      .clock,
      .read_address,
      .b_read_address(b_address),
      .x(x),
      .r(r),
      .b(b),
      .previous(previous),
      .q(q),
      .x_write(written && (pass == Update || pass == Guess || clears ||
                           (pass == Residual && exchange))),
      .r_write(written && (pass == Residual || (pass == Update && !exchange))),
      .write_address(written_address),
      .x_new(clears ? '0 : exchange ? late_d : late_sum),
      .r_new(late_r),
      .previous_write,
      .previous_address,
      .q_write,
      .q_address,
      .q_new(q_written),
      .host_x_write,
      .host_b_write,
      .host_address,
      .host_word
  );
  row_writer #(
      .SumBits(SumBits),
      .ProductBits(Q),
      .ProductShift(ProductShift),
      .Written(RowWritten)
  ) writer (
      .clock,
      .rounding,
      .zero,
      .sum(sum),
      .q(q2),
      .clamped(q_clamped2),
      .q_written(q_written)
  );
  vector_lane #(
      .VectorBits(V),
      .ProductBits(Q),
      .CoefficientBits(CoefficientBits),
      .StaticBits(StaticBits),
      .ProductShift(ProductShift)
  ) lane (
      .clock,
      .pass,
      .exchange,
      .alone,
      .rounding,
      .static_shift,
      .coefficient,
      .right_d,
      .right_q,
      .right_r,
      .beyond_d,
      .beyond_q,
      .beyond_r,
      .x(x),
      .previous(previous),
      .d(d),
      .r(r),
      .b(b),
      .q(pass == Product ? q2 : q),
      .b_clamped(b_clamped3),
      .difference(difference4),
      .q_d(q_d6),
      .sum_word(sum_word11),
      .r_word(r_word11),
      .old_d(old_d11),
      .sum_clamped(sum_clamped11),
      .r_clamped(r_clamped11),
      .square(square14)
  );

  logic [3*V-1:0] late[12:Written-1];
  always_ff @(posedge clock) begin
    late[12] <= {sum_word11, r_word11, old_d11};
    for (int i = 13; i < Written; ++i) late[i] <= late[i-1];
    direction_new <= late_sum;
  end
  assign {late_sum, late_r, late_d} = late[Written-1];

endmodule

`default_nettype wire
