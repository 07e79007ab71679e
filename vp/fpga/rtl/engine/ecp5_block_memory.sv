// block_memory of an ECP5's block RAMs. No word is read at the edge that writes it.
//
// A block with a reading and a writing port is 36 bits wide, and inferred; only one with two ports
// that do both, of 18 bits, can be asked for its output register.
`default_nettype none

module ecp5_block_memory #(
    parameter int Width = 16,
    parameter int AddressBits = 9
) (
    input wire clock,
    input wire write,
    input wire [AddressBits-1:0] write_address,
    input wire [Width-1:0] write_word,
    input wire [AddressBits-1:0] read_address,
    output wire [Width-1:0] word
);

  if (Width <= 18 || AddressBits > 9) begin : g_ports
    wire [Width-1:0] unused;
    ecp5_memory #(
        .Width(Width),
        .AddressBits(AddressBits)
    ) memory (
        .clock,
        .write({1'b0, write}),
        .address({read_address, write_address}),
        .write_word({Width'(0), write_word}),
        .registers(1'b1),
        .word({word, unused})
    );
  end else begin : g_inferred
    (* no_rw_check *) logic [Width-1:0] cells[2**AddressBits];
    logic [Width-1:0] read, read_before;
    always_ff @(posedge clock) begin
      if (write) cells[write_address] <= write_word;
      read <= cells[read_address];
      read_before <= read;
    end
    assign word = read_before;
  end

endmodule

`default_nettype wire
