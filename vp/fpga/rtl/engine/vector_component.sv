// A component of a lane with its memories: the words that are read, what the lane makes of them and
// of a row's sum, and what is written. Ranks are those of vector_lane.sv; words wait from rank 11 to
// the one before the edge that writes them, PhaseClocks - 5.
`default_nettype none

module vector_component
  import engine_types::*;
#(
    parameter int Preconditioner = 0,  // of Jacobi, of blocks
    parameter int Component = 0,
    parameter int VectorBits = 16,
    parameter int ResidualBits = 16,
    parameter int DirectionBits = 16,
    parameter int ProductBits = 32,
    parameter int CoefficientBits = 16,
    parameter int StaticBits = 4,
    parameter int ProductShift = 0,
    parameter int SumBits = 38,
    parameter int AddressBits = 9,
    parameter int PhaseClocks = 20,
    localparam int InverseWords = inverse_words(Preconditioner),
    localparam int InverseWidth = inverse_bits(Preconditioner),
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
    input wire wide,  // the preconditioner works
    input wire [5:0] inverse_shift,
    input wire [6:0] right_d,
    input wire [6:0] right_q,
    input wire [6:0] right_r,
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
    input wire z_write,  // rank 18
    input wire [AddressBits-1:0] z_address,
    input wire [AddressBits-1:0] inverse_read_address,
    output wire [InverseWords-1:0][InverseWidth-1:0] inverse,
    input wire inverse_write,
    input wire [AddressBits-1:0] inverse_address,
    input wire [InverseWords-1:0][InverseWidth-1:0] inverse_new,
    input wire host_x_write,
    input wire host_b_write,
    input wire [AddressBits-1:0] host_address,
    input wire [ResidualBits-1:0] host_word,
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
    output wire [ResidualBits-1:0] r_word11,
    input wire [2:0][ResidualBits-1:0] node_r11,  // of the node's components
    output wire sum_clamped11,
    output wire r_clamped11,
    output wire [2*ResidualBits-3:0] square,  // rank 14, with a preconditioner 15
    output wire [ResidualBits-2:0] z_size18,
    output wire signed [2*ResidualBits-2:0] z_r21,
    output logic [VectorBits-1:0] direction_new  // with the edge that writes the others
);

  localparam int V = VectorBits;
  localparam int R = ResidualBits;
  localparam int Q = ProductBits;
  localparam int Written = PhaseClocks - 5;
  localparam int RowWritten = PhaseClocks - 11;

  wire [V-1:0] previous, old_d11;
  wire [R-1:0] r, b, z, z18;
  wire [Q-1:0] q, q_written;
  wire [V-1:0] late_sum, late_d;
  wire [R-1:0] late_r;
  wire makes_d = pass == FirstDirection || pass == Direction;
  wire clears = pass == Residual && zero;

  vector_bank #(
      .Preconditioner(Preconditioner),
      .VectorBits(V),
      .ResidualBits(R),
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
      .z(z),
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
      .z_write,
      .z_address,
      .z_new(z18),
      .inverse_read_address,
      .inverse,
      .inverse_write,
      .inverse_address,
      .inverse_new,
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
      .ResidualBits(R),
      .DirectionBits(DirectionBits),
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
      .wide,
      .right_d,
      .right_q,
      .right_r,
      .beyond_d,
      .beyond_q,
      .beyond_r,
      .x(x),
      .previous(previous),
      .d(d),
      .r(Preconditioner != 0 && wide && makes_d ? z : r),
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
      .square
  );
  if (Preconditioner == 2) begin : g_blocks
    block_preconditioner_lane #(
        .Bits(R),
        .Component(Component)
    ) preconditioner (
        .clock,
        .rounding,
        .shift(inverse_shift),
        .r(node_r11),
        .inverse,
        .z(z18),
        .z_size(z_size18),
        .z_r(z_r21)
    );
  end else if (Preconditioner == 1) begin : g_preconditioner
    wire [2*R-3:0] z_r;
    assign z_r21 = {1'b0, z_r};
    preconditioner_lane #(
        .Bits(R)
    ) preconditioner (
        .clock,
        .rounding,
        .shift(inverse_shift),
        .r(r_word11),
        .inverse(inverse[0]),
        .z(z18),
        .z_size(z_size18),
        .z_r
    );
    wire unused = &{1'b0, node_r11};
  end else begin : g_z_is_r
    assign z18 = '0;
    assign z_size18 = '0;
    assign z_r21 = '0;
    wire unused = &{1'b0, inverse_shift, node_r11};
  end

  logic [2*V+R-1:0] late[12:Written-1];
  always_ff @(posedge clock) begin
    late[12] <= {sum_word11, r_word11, old_d11};
    for (int i = 13; i < Written; ++i) late[i] <= late[i-1];
    direction_new <= late_sum;
  end
  assign {late_sum, late_r, late_d} = late[Written-1];

endmodule

`default_nettype wire
