// What the vector unit finds out about the words of a pass: the exact inner products, the largest
// magnitudes, and how many words were clamped (engine::VectorStatus). Without a preconditioner z is r.
//
// Inputs have the ranks of vector_lane.sv; each validity is that of its inputs' rank.
`default_nettype none

module vector_sums
  import engine_types::*;
#(
    parameter int Preconditioner = 0,  // of Jacobi, of blocks
    parameter int Lanes = 2,
    parameter int VectorBits = 16,
    parameter int ResidualBits = 16,
    parameter int ProductBits = 32,
    parameter int DifferenceBits = 33,
    parameter int DotBits = 60,
    parameter int SquareBits = 60
) (
    input wire clock,
    input wire start,  // of a pass: what it finds is cleared
    input wire clear_clamped,
    input wire pass_t pass,
    input wire hold,
    input wire compare,
    input wire exchange,
    input wire counts_b,  // clamped words of b are counted
    input wire wide,      // the preconditioner works
    // Rows.
    input wire [Lanes-1:0] rows2,
    input wire [Lanes-1:0] rows4,
    input wire [Lanes-1:0] square_rows,
    input wire [Lanes-1:0] rows6,
    input wire [Lanes-1:0][2:0][ProductBits-1:0] q2,
    input wire [Lanes-1:0][2:0] q_clamped2,
    input wire [Lanes-1:0][2:0][DifferenceBits-1:0] difference4,
    input wire [Lanes-1:0][2:0][ProductBits+VectorBits-1:0] q_d6,
    // Groups of nodes.
    input wire [Lanes-1:0] nodes3,
    input wire [Lanes-1:0] nodes11,
    input wire [Lanes-1:0] square_nodes,
    input wire [Lanes-1:0] nodes18,
    input wire [Lanes-1:0] nodes21,
    input wire [Lanes-1:0][2:0] b_clamped3,
    input wire [Lanes-1:0][2:0][VectorBits-1:0] sum_word11,
    input wire [Lanes-1:0][2:0][ResidualBits-1:0] r_word11,
    input wire [Lanes-1:0][2:0] sum_clamped11,
    input wire [Lanes-1:0][2:0] r_clamped11,
    input wire [Lanes-1:0][2:0][2*ResidualBits-3:0] square,  // of r, or of a row's b
    input wire [Lanes-1:0][2:0][ResidualBits-2:0] z_size18,
    input wire [Lanes-1:0][2:0][2*ResidualBits-2:0] z_r21,  // signed: of blocks a term can be negative
    output logic signed [DotBits-1:0] dot,   // d.q of a product
    output logic [SquareBits-1:0] squares,   // b.b of a product, or r.r
    output wire signed [SquareBits:0] z_dot_r,
    output wire [ResidualBits-2:0] largest_r,
    output wire [ResidualBits-2:0] largest_z,
    output wire [VectorBits-2:0] largest_d,
    output wire [ProductBits-2:0] largest_q,
    output logic [DifferenceBits-1:0] widest,  // as long as the largest |b - q|
    output logic [31:0] clamped
);

  localparam int V = VectorBits;
  localparam int R = ResidualBits;
  localparam int Q = ProductBits;
  localparam int Words = 3 * Lanes;
  localparam int CountBits = $clog2(9 * Lanes + 1);

  wire makes_r = pass == Residual || (pass == Update && !exchange);
  wire makes_d = pass == FirstDirection || pass == Direction;
  wire counts_sum = pass == Update || pass == Guess || makes_d;

  // ---- Magnitudes, in a rank before they are compared.
  function automatic logic [V-2:0] size(input logic [V-1:0] word);
    return word[V-1] ? (V - 1)'(-word) : word[V-2:0];
  endfunction
  function automatic logic [R-2:0] r_size(input logic [R-1:0] word);
    return word[R-1] ? (R - 1)'(-word) : word[R-2:0];
  endfunction
  function automatic logic [Q-2:0] q_size(input logic [Q-1:0] word);
    return word[Q-1] ? (Q - 1)'(-word) : word[Q-2:0];
  endfunction
  logic [Words-1:0] has_q3, has_r12, has_d12;
  logic [Words-1:0][Q-2:0] q_size3;
  logic [Words-1:0][R-2:0] r_size12;
  logic [Words-1:0][V-2:0] d_size12;
  always_ff @(posedge clock) begin
    for (int l = 0; l < Lanes; ++l) begin
      for (int c = 0; c < 3; ++c) begin
        has_q3[3*l+c] <= rows2[l] && !hold && !start;
        has_r12[3*l+c] <= nodes11[l] && !hold && makes_r && !start;
        has_d12[3*l+c] <= nodes11[l] && !hold && makes_d && !start;
        q_size3[3*l+c] <= q_size(q2[l][c]);
        r_size12[3*l+c] <= r_size(r_word11[l][c]);
        d_size12[3*l+c] <= size(sum_word11[l][c]);
      end
    end
  end
  largest_magnitude #(
      .Bits(Q - 1),
      .Words(Words)
  ) most_q (
      .clock,
      .clear(start && pass == Product),
      .valid(has_q3),
      .magnitude(q_size3),
      .largest(largest_q)
  );
  largest_magnitude #(
      .Bits(R - 1),
      .Words(Words)
  ) most_r (
      .clock,
      .clear(start && (pass == Residual || pass == Update)),
      .valid(has_r12),
      .magnitude(r_size12),
      .largest(largest_r)
  );
  largest_magnitude #(
      .Bits(V - 1),
      .Words(Words)
  ) most_d (
      .clock,
      .clear(start && makes_d),
      .valid(has_d12),
      .magnitude(d_size12),
      .largest(largest_d)
  );

  // ---- Sums: of a lane's components, over the lanes, and over the pass.
  logic signed [Lanes-1:0][Q+V+1:0] q_d_lane, q_d_lane7;
  logic signed [Q+V+2:0] q_d_sum, q_d_sum8;
  logic [Lanes-1:0][2*R-1:0] square_lane, square_lane_late;
  logic [2*R+2:0] square_sum, square_sum_late;
  logic [DifferenceBits-1:0] bits_of_difference;
  logic [Lanes-1:0][CountBits-1:0] clamps_lane, clamps_lane_now;
  logic [CountBits-1:0] clamps, clamps_now;

  always_comb begin
    q_d_sum = '0;
    square_sum = '0;
    bits_of_difference = widest;
    clamps = '0;
    for (int l = 0; l < Lanes; ++l) begin
      automatic logic squares_here = square_nodes[l] || (square_rows[l] && compare);
      q_d_lane[l] = '0;
      square_lane[l] = '0;
      clamps_lane[l] = '0;
      for (int c = 0; c < 3; ++c) begin
        q_d_lane[l] = q_d_lane[l] + (Q + V + 2)'($signed(rows6[l] ? q_d6[l][c] : '0));
        square_lane[l] = square_lane[l] + (squares_here ? (2 * R)'(square[l][c]) : '0);
        if (rows4[l] && compare) bits_of_difference = bits_of_difference | difference4[l][c];
        clamps_lane[l] = clamps_lane[l] + CountBits'(rows2[l] && !hold && q_clamped2[l][c]) +
                         CountBits'(nodes3[l] && counts_b && b_clamped3[l][c]) +
                         CountBits'(nodes11[l] && !hold && makes_r && r_clamped11[l][c]) +
                         CountBits'(nodes11[l] && !hold && counts_sum && sum_clamped11[l][c]);
      end
      q_d_sum = q_d_sum + (Q + V + 3)'($signed(q_d_lane7[l]));
      square_sum = square_sum + (2 * R + 3)'(square_lane_late[l]);
      clamps = clamps + clamps_lane_now[l];
    end
  end

  always_ff @(posedge clock) begin
    q_d_lane7 <= q_d_lane;
    q_d_sum8 <= q_d_sum;
    square_lane_late <= square_lane;
    square_sum_late <= square_sum;
    if (pass == Product) dot <= dot + DotBits'(q_d_sum8);
    if (pass == Product || makes_r) squares <= squares + SquareBits'(square_sum_late);
    widest <= bits_of_difference;
    clamps_lane_now <= clamps_lane;
    clamps_now <= clamps;
    clamped <= clamped + 32'(clamps_now);
    if (start) begin
      dot <= '0;
      q_d_lane7 <= '0;
      q_d_sum8 <= '0;
      if (pass == Product || pass == Residual || pass == Update) begin
        squares <= '0;
        square_lane_late <= '0;
        square_sum_late <= '0;
      end
      widest <= '0;
    end
    if (clear_clamped) begin
      clamped <= '0;
      clamps_lane_now <= '0;
      clamps_now <= '0;
    end
  end

  // ---- Of z, whose ranks go on beyond the end of the pass.
  if (Preconditioner != 0) begin : g_preconditioner
    wire [R-2:0] largest;
    logic [Words-1:0] has_z18;
    logic signed [2*R+2:0] z_r_sum, z_r_sum_late;
    logic signed [SquareBits:0] sum;
    wire clear = start && (pass == Residual || pass == Update);
    always_comb begin
      z_r_sum = '0;
      for (int l = 0; l < Lanes; ++l) begin
        for (int c = 0; c < 3; ++c) begin
          has_z18[3*l+c] = nodes18[l];
          z_r_sum = z_r_sum + (2 * R + 3)'($signed(nodes21[l] ? z_r21[l][c] : '0));
        end
      end
    end
    largest_magnitude #(
        .Bits(R - 1),
        .Words(Words)
    ) most_z (
        .clock,
        .clear,
        .valid(has_z18),
        .magnitude(z_size18),
        .largest
    );
    always_ff @(posedge clock) begin
      z_r_sum_late <= z_r_sum;
      sum <= sum + (SquareBits + 1)'(z_r_sum_late);
      if (clear) begin
        z_r_sum_late <= '0;
        sum <= '0;
      end
    end
    assign largest_z = wide ? largest : largest_r;
    assign z_dot_r = wide ? sum : {1'b0, squares};
  end else begin : g_z_is_r
    assign largest_z = largest_r;
    assign z_dot_r = {1'b0, squares};
    wire unused = &{1'b0, wide, nodes18, nodes21, z_size18, z_r21};
  end

endmodule

`default_nettype wire
