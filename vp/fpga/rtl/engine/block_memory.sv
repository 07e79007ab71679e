// A block RAM with a write port and a read port and with its output register: a word comes two
// clocks behind the edge at which its address is seen.
//
// The read port sees a word one clock after the edge that wrote it.
`default_nettype none

module block_memory #(
    parameter int Width = 16,
    parameter int AddressBits = 9
) (
    input wire clock,
    input wire write,
    input wire [AddressBits-1:0] write_address,
    input wire [Width-1:0] write_word,
    input wire [AddressBits-1:0] read_address,
    output logic [Width-1:0] word
);

  logic [Width-1:0] cells[2**AddressBits];
  logic [Width-1:0] read;

  always_ff @(posedge clock) begin
    if (write) cells[write_address] <= write_word;
    read <= cells[read_address];
    word <= read;
  end

endmodule

`default_nettype wire
