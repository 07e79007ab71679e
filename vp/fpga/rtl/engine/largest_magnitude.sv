// The largest magnitude of the words that a pass brings, some at a clock: `Words` magnitudes are
// compared in pairs, a rank for each level of the tree, and then with what there was.
//
// `largest` knows of words Ranks + 1 clocks behind the edge that sees them.
`default_nettype none

module largest_magnitude #(
    parameter int Bits = 15,
    parameter int Words = 6,
    localparam int Ranks = $clog2(Words)
) (
    input wire clock,
    input wire clear,
    input wire [Words-1:0] valid,
    input wire [Words-1:0][Bits-1:0] magnitude,
    output logic [Bits-1:0] largest
);

  // Level i has 2^(Ranks-i) words, of which those beyond the last one stay zero.
  for (genvar i = 0; i <= Ranks; ++i) begin : g_level
    wire [2**(Ranks-i)-1:0][Bits-1:0] word;
    if (i == 0) begin : g_words
      for (genvar w = 0; w < 2 ** Ranks; ++w) begin : g_word
        if (w < Words) begin : g_valid
          assign word[w] = valid[w] ? magnitude[w] : '0;
        end else begin : g_none
          assign word[w] = '0;
        end
      end
    end else begin : g_pairs
      logic [2**(Ranks-i)-1:0][Bits-1:0] larger;
      always_ff @(posedge clock) begin
        for (int w = 0; w < 2 ** (Ranks - i); ++w) begin
          larger[w] <= g_level[i-1].word[2*w+1] > g_level[i-1].word[2*w]
                           ? g_level[i-1].word[2*w+1] : g_level[i-1].word[2*w];
        end
        if (clear) larger <= '0;
      end
      assign word = larger;
    end
  end

  always_ff @(posedge clock) begin
    if (g_level[Ranks].word[0] > largest) largest <= g_level[Ranks].word[0];
    if (clear) largest <= '0;
  end

endmodule

`default_nettype wire
