// P^-1 of the preconditioner of 3 x 3 blocks (fixed::ReferencePreconditioner): of each node the inverse
// of its block of the matrix, adjugate * 2^(MatrixBits + InverseBits) / determinant, rounded to nearest
// and halved until all nine words fit; of a block that is not positive definite the inverse diagonal.
//
// A node takes the clocks of six quotients: the cofactors and the determinant are formed a product a
// clock, then a serial divider makes the six words that are different. An order for one node takes
// PhaseClocks more, as one for all does (inverse_order.sv).
`default_nettype none

module block_inverse_maker
  import engine_types::*;
#(
    parameter int MatrixBits = 12,
    parameter int NodeBits = 10,
    parameter int PhaseClocks = 20,
    parameter int DivisionClocks = 68
) (
    input wire clock,
    input wire reset,
    input wire [NodeBits:0] nodes,
    input wire all,
    input wire one,
    input wire [NodeBits-1:0] edited_node,
    output wire busy,
    output wire inverts_all,
    output wire look,
    output wire [NodeBits-1:0] node,
    input wire looked,
    input wire [2:0][2:0][MatrixBits-1:0] own_block,
    // The memory of P^-1, of which a row's words, each a sign and a magnitude, come two clocks behind
    // the address.
    output logic [1:0] component,
    output logic write,
    output logic [2:0][WideBits-1:0] words,
    input wire [2:0][WideBits-1:0] old_words,
    output wire [5:0] shift
);

  localparam int M = MatrixBits;
  localparam int CofactorBits = 2 * M - 1;      // of a magnitude
  localparam int DeterminantBits = 3 * M;
  localparam int Steps = CofactorBits + M + InverseBits;  // bits of the numerator
  localparam int StepBits = $clog2(Steps);
  localparam int LimitBits = 29;                // of a magnitude in P^-1
  localparam int Lengths = WideBits + 2;        // rows add up to 0 to 33 bits
  localparam int Products = 15;                 // two a cofactor, three for the determinant

  typedef enum logic [3:0] {
    Wait,
    Multiply,
    Decide,
    Load,
    Step,
    Round,
    Length,
    Halve,
    AddUp,
    Write,
    CountOld,
    CountNew
  } state_t;
  state_t state;

  wire last_component = component == 2'd2;
  wire begins, of_all;
  inverse_order #(
      .NodeBits(NodeBits),
      .PhaseClocks(PhaseClocks),
      .NodeClocks(6 * DivisionClocks),
      .OneMore(PhaseClocks)
  ) order (
      .clock,
      .reset,
      .nodes,
      .all,
      .one,
      .edited_node,
      .busy,
      .of_all,
      .look,
      .node,
      .looked,
      .begins,
      .made(state == CountNew && last_component)
  );
  assign inverts_all = busy && of_all;

  // ---- Cofactors and determinant. The entries of a symmetric block are numbered 00, 01, 02, 11, 12, 22.
  wire signed [M-1:0] a00 = own_block[0][0];
  wire signed [M-1:0] a01 = own_block[0][1];
  wire signed [M-1:0] a02 = own_block[0][2];
  wire signed [M-1:0] a11 = own_block[1][1];
  wire signed [M-1:0] a12 = own_block[1][2];
  wire signed [M-1:0] a22 = own_block[2][2];
  logic [3:0] product_number, product_number1, product_number2;
  logic product_valid1, product_valid2;
  logic signed [M-1:0] left_factor;
  logic signed [2*M:0] right_factor;
  logic signed [3*M:0] product;
  logic [5:0][2*M:0] cofactor;
  logic signed [3*M:0] determinant;
  always_ff @(posedge clock) begin
    product_valid1 <= state == Multiply && product_number < 4'(Products);
    product_number1 <= product_number;
    product_valid2 <= product_valid1;
    product_number2 <= product_number1;
    case (product_number)
      4'd0: {left_factor, right_factor} <= {a11, (2 * M + 1)'(a22)};
      4'd1: {left_factor, right_factor} <= {a12, (2 * M + 1)'(a12)};
      4'd2: {left_factor, right_factor} <= {a02, (2 * M + 1)'(a12)};
      4'd3: {left_factor, right_factor} <= {a01, (2 * M + 1)'(a22)};
      4'd4: {left_factor, right_factor} <= {a01, (2 * M + 1)'(a12)};
      4'd5: {left_factor, right_factor} <= {a02, (2 * M + 1)'(a11)};
      4'd6: {left_factor, right_factor} <= {a00, (2 * M + 1)'(a22)};
      4'd7: {left_factor, right_factor} <= {a02, (2 * M + 1)'(a02)};
      4'd8: {left_factor, right_factor} <= {a01, (2 * M + 1)'(a02)};
      4'd9: {left_factor, right_factor} <= {a00, (2 * M + 1)'(a12)};
      4'd10: {left_factor, right_factor} <= {a00, (2 * M + 1)'(a11)};
      4'd11: {left_factor, right_factor} <= {a01, (2 * M + 1)'(a01)};
      4'd12: {left_factor, right_factor} <= {a00, cofactor[0]};
      4'd13: {left_factor, right_factor} <= {a01, cofactor[1]};
      default: {left_factor, right_factor} <= {a02, cofactor[2]};
    endcase
    product <= left_factor * right_factor;
    if (begins) determinant <= '0;
    if (product_valid2) begin
      if (product_number2 >= 4'd12) begin
        determinant <= determinant + product;
      end
      for (int e = 0; e < 6; ++e) begin
        if (product_number2 == 4'(2 * e)) cofactor[e] <= product[2*M:0];
        if (product_number2 == 4'(2 * e + 1)) cofactor[e] <= cofactor[e] - product[2*M:0];
      end
    end
  end
  logic definite;

  // ---- The divider: a bit of the numerator a clock.
  logic [2:0] entry;
  logic [CofactorBits-1:0] numerator;
  logic [DeterminantBits-1:0] divisor, rest;
  logic divides, negative;
  logic [Steps-1:0] quotient;
  logic [StepBits-1:0] steps;
  wire [2*M:0] cofactor_now = cofactor[entry];
  wire [2*M:0] cofactor_size = cofactor_now[2*M] ? -cofactor_now : cofactor_now;
  wire signed [M-1:0] diagonal_now = entry == 3'd0 ? a00 : entry == 3'd3 ? a11 : a22;
  wire on_diagonal = entry == 3'd0 || entry == 3'd3 || entry == 3'd5;
  wire [DeterminantBits-1:0] dividend = {rest[DeterminantBits-2:0], numerator[CofactorBits-1]};
  wire fits = dividend >= divisor;
  wire up = {rest, 1'b0} >= {1'b0, divisor};

  // ---- The six words, which go round: the first one is entry 0 again behind six steps.
  logic [5:0][Steps-1:0] sizes;
  logic [5:0] signs;
  logic [Steps-1:0] some_bits;  // of any of them
  logic [6:0] halvings;
  function automatic logic [6:0] bits_of(input logic [Steps-1:0] value);
    bits_of = '0;
    for (int i = 0; i < Steps; ++i) if (value[i]) bits_of = 7'(i + 1);
  endfunction
  wire [6:0] some_length = bits_of(some_bits);
  wire [Steps-1:0] halved = sizes[0] >> halvings;
  wire too_long = |halved[Steps-1:LimitBits];
  wire [LimitBits-1:0] kept = too_long ? '1 : halved[LimitBits-1:0];

  // The words of a row.
  logic [2:0][2:0] entries;
  always_comb begin
    case (component)
      2'd0: entries = {3'd2, 3'd1, 3'd0};
      2'd1: entries = {3'd4, 3'd3, 3'd1};
      default: entries = {3'd5, 3'd4, 3'd2};
    endcase
  end

  // ---- Rows by the bits of what their magnitudes add up to.
  logic [WideBits:0] new_sum, old_sum;
  function automatic logic [5:0] length(input logic [WideBits:0] value);
    length = '0;
    for (int i = 0; i <= WideBits; ++i) if (value[i]) length = 6'(i + 1);
  endfunction
  logic [5:0] old_length, new_length;
  row_lengths #(
      .CountBits(NodeBits + 2),
      .Lengths(Lengths)
  ) lengths (
      .clock,
      .clear(all),
      .leaves(state == CountOld),
      .enters(state == CountNew),
      .length(state == CountOld ? old_length : new_length),
      .shift
  );

  always_ff @(posedge clock) begin
    write <= 1'b0;
    case (state)
      Multiply: begin
        product_number <= product_number + 1'b1;
        // The last product is summed with the edge that follows its second register.
        if (product_number == 4'(Products) && !product_valid1 && !product_valid2) state <= Decide;
        if (product_number == 4'(Products)) product_number <= product_number;
      end
      Decide: begin
        definite <= a00 > 0 && $signed(cofactor[5]) > 0 && determinant > 0;
        entry <= '0;
        some_bits <= '0;
        state <= Load;
      end
      Load: begin
        numerator <= definite ? cofactor_size[CofactorBits-1:0] : CofactorBits'(1);
        negative <= definite && cofactor_now[2*M];
        divisor <= definite ? determinant[DeterminantBits-1:0] : DeterminantBits'(diagonal_now);
        divides <= definite || (on_diagonal && diagonal_now > 0);
        rest <= '0;
        quotient <= '0;
        steps <= StepBits'(Steps - 1);
        state <= Step;
      end
      Step: begin
        rest <= fits ? dividend - divisor : dividend;
        numerator <= numerator << 1;
        quotient <= {quotient[Steps-2:0], fits};
        steps <= steps - 1'b1;
        if (steps == '0) state <= Round;
      end
      Round: begin
        sizes <= {divides ? quotient + Steps'(up) : '0, sizes[5:1]};
        signs <= {negative, signs[5:1]};
        if (divides) some_bits <= some_bits | (quotient + Steps'(up));
        entry <= entry + 1'b1;
        state <= entry == 3'd5 ? Length : Load;
      end
      Length: begin
        halvings <= definite && some_length > 7'(LimitBits) ? some_length - 7'(LimitBits) : '0;
        entry <= '0;
        state <= Halve;
      end
      Halve: begin
        sizes <= {Steps'(kept), sizes[5:1]};
        entry <= entry + 1'b1;
        if (entry == 3'd5) state <= AddUp;
      end
      AddUp: begin
        new_sum <= (WideBits + 1)'(sizes[entries[0]]) + (WideBits + 1)'(sizes[entries[1]]) +
                   (WideBits + 1)'(sizes[entries[2]]);
        old_sum <= (WideBits + 1)'(old_words[0][WideBits-2:0]) +
                   (WideBits + 1)'(old_words[1][WideBits-2:0]) +
                   (WideBits + 1)'(old_words[2][WideBits-2:0]);
        state <= Write;
      end
      Write: begin
        for (int k = 0; k < 3; ++k) begin
          words[k] <= {signs[entries[k]], (WideBits - 1)'(sizes[entries[k]])};
        end
        write <= 1'b1;
        old_length <= length(old_sum);
        new_length <= length(new_sum);
        state <= of_all ? CountNew : CountOld;
      end
      CountOld: state <= CountNew;
      CountNew: begin
        component <= component + 1'b1;
        state <= last_component ? Wait : AddUp;
      end
      default: ;
    endcase
    if (begins) begin
      component <= '0;
      product_number <= '0;
      state <= Multiply;
    end
    if (all) state <= Wait;
    if (reset) begin
      write <= 1'b0;
      state <= Wait;
    end
  end

  wire unused = &{1'b0, own_block, cofactor_size, determinant};

endmodule

`default_nettype wire
