// The registers by which the host tells the engine what to solve. Their numbers are the addresses of
// SpaceSettings: they hold still while a solve runs.
`default_nettype none

module engine_settings
  import engine_types::*;
#(
    parameter int VectorBits = 16,
    parameter int MatrixBits = 12,
    parameter int NodeBits = 10
) (
    input wire clock,
    input wire write,
    input wire [3:0] address,
    input wire [31:0] word,
    output logic [NodeBits:0] nodes,
    output logic [15:0] iterations,
    output logic [15:0] replace_every,
    output logic [4:0] static_shift,
    output logic [4:0] target,  // bits of magnitude that scaling up leaves: all but the headroom
    output logic [4:0] threshold,
    output logic [4:0] step,
    output logic starts_zero,
    output logic extrapolated,
    output logic dynamic_scaling,
    output logic scaling_down,
    output logic preconditions,  // by the inverse diagonal
    output rounding_t shift_rounding,
    output rounding_t division_rounding,
    // The square of the stop test's tolerance; without a mantissa nothing is tested.
    output logic [52:0] tolerance,
    output logic signed [11:0] tolerance_exponent,
    // Of an order to the matrix editor.
    output logic [NodeBits-1:0] edited_node,
    output logic restores,
    output logic [MatrixBits-1:0] diagonal
);

  always_ff @(posedge clock) begin
    if (write) begin
      case (address)
        4'd0: nodes <= word[NodeBits:0];
        4'd1: iterations <= word[15:0];
        4'd2: replace_every <= word[15:0];
        4'd3: static_shift <= word[4:0];
        4'd4: target <= 5'(VectorBits - 1) - word[4:0];
        4'd5: threshold <= word[4:0];
        4'd6: step <= word[4:0];
        4'd7: {preconditions, scaling_down, dynamic_scaling, extrapolated, starts_zero} <= word[4:0];
        4'd8: shift_rounding <= rounding_t'(word[1:0]);
        4'd9: division_rounding <= rounding_t'(word[1:0]);
        4'd10: edited_node <= word[NodeBits-1:0];
        4'd11: restores <= word[0];
        4'd12: diagonal <= word[MatrixBits-1:0];
        4'd13: tolerance[31:0] <= word;
        4'd14: tolerance[52:32] <= word[20:0];
        4'd15: tolerance_exponent <= word[11:0];
      endcase
    end
  end
  wire unused = &{1'b0, word};

endmodule

`default_nettype wire
