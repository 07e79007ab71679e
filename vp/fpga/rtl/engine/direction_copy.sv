// A component of a partition's copy of d, dealt node by node to Banks memories (direction_bank.sv).
//
// Ranks: 0 the addresses, 1 the words. What a package reads in an earlier turn than its last one is
// kept until then.
`default_nettype none

module direction_copy #(
    parameter int Width = 16,
    parameter int NodeBits = 10,
    parameter int Nodes = 4,  // of a package
    parameter int Lanes = 2,
    parameter int Banks = 1,
    parameter int Memory = 0,
    parameter int Accesses = 4
) (
    input wire clock,
`ifdef ECP5
    input wire clock2,
`endif
    input wire product,
    // The package that is served: which of its nodes have the component, their reads' numbers in
    // their banks, and its turn.
    input wire [Nodes-1:0][NodeBits-1:0] node,
    input wire [Nodes-1:0] reads,
    input wire [Nodes-1:0][2:0] number,
    input wire [1:0] turn,
    output wire [Nodes-1:0][Width-1:0] word,
    input wire [NodeBits-1:0] pass_node,  // of the first lane
    output wire [Lanes-1:0][Width-1:0] pass_word,
    input wire [Lanes-1:0] write,
    input wire [NodeBits-1:0] write_node,
    input wire [Lanes-1:0][Width-1:0] write_word
);

  localparam int BankBits = $clog2(Banks);
  localparam int AddressBits = NodeBits - BankBits;
  // A group's nodes are all in one memory each, or some in every memory.
  localparam int InBank = Lanes > Banks ? Lanes / Banks : 1;
  localparam int Groups = Banks > Lanes ? Banks / Lanes : 1;
  localparam int GroupBits = Groups > 1 ? $clog2(Groups) : 1;
  localparam bit Direct = Banks == 1 && Nodes <= Accesses;  // a port is always the same node's
  localparam bit Waits = Nodes > Accesses;
  localparam int Wanted = Nodes < Accesses ? Nodes : Accesses;
  localparam int Reads = Wanted > InBank ? Wanted : InBank;

  wire [Banks-1:0][Reads-1:0][Width-1:0] words;
  wire [Banks-1:0][InBank-1:0][Width-1:0] pass_words;
  logic [Banks-1:0][Reads-1:0][AddressBits-1:0] address;
  wire [GroupBits-1:0] pass_group, write_group;
  if (Groups > 1) begin : g_groups
    assign pass_group = pass_node[BankBits-1-:GroupBits];
    assign write_group = write_node[BankBits-1-:GroupBits];
  end else begin : g_group
    assign pass_group = '0;
    assign write_group = '0;
  end

  for (genvar b = 0; b < Banks; ++b) begin : g_bank
    wire [InBank-1:0] writes;
    wire [InBank-1:0][Width-1:0] written;
    for (genvar i = 0; i < InBank; ++i) begin : g_lane
      localparam int Lane = Lanes > Banks ? b + i * Banks : b % Lanes;
      assign writes[i] = write[Lane] && write_group == GroupBits'(b / Lanes);
      assign written[i] = write_word[Lane];
    end
    direction_bank #(
        .Width(Width),
        .AddressBits(AddressBits),
        .Memory(Memory),
        .Reads(Reads),
        .Lanes(InBank),
        .AddressesInRegisters(Direct)
    ) bank (
        .clock,
`ifdef ECP5
        .clock2,
`endif
        .product,
        .package_address(address[b]),
        .pass_address(pass_node[NodeBits-1:BankBits]),
        .word(words[b]),
        .pass_word(pass_words[b]),
        .write(writes),
        .write_address(write_node[NodeBits-1:BankBits]),
        .write_word(written)
    );
  end

  // ---- A pass.
  if (Lanes > Banks) begin : g_all
    for (genvar l = 0; l < Lanes; ++l) begin : g_pass
      assign pass_word[l] = pass_words[l%Banks][l/Banks];
    end
  end else begin : g_some
    wire [Groups-1:0][Lanes-1:0][Width-1:0] of_groups;
    logic [GroupBits-1:0] group0, group1;
    always_ff @(posedge clock) begin
      group0 <= pass_group;
      group1 <= group0;
    end
    for (genvar b = 0; b < Banks; ++b) begin : g_group
      assign of_groups[b/Lanes][b%Lanes] = pass_words[b][0];
    end
    assign pass_word = of_groups[group1];
  end
  wire unused_bits = &{1'b0, pass_node, write_node, pass_group};

  // ---- A package.
  if (Direct) begin : g_direct
    for (genvar r = 0; r < Reads; ++r) assign address[0][r] = node[r<Nodes?r : 0];
    assign word = words[0][Nodes-1:0];
    wire unused = &{1'b0, reads, number, turn, words};
  end else begin : g_dealt
    localparam int PlaceBits = BankBits > 0 ? BankBits : 1;
    typedef logic [PlaceBits-1:0] bank_t;
    logic [Nodes-1:0][PlaceBits-1:0] bank, bank0, bank1;
    logic [Nodes-1:0][1:0] port, port0, port1;
    logic [Nodes-1:0] now, now0, now1;
    logic [Nodes-1:0][Width-1:0] kept;
    always_comb begin
      address = '0;
      for (int n = 0; n < Nodes; ++n) begin
        bank[n] = Banks > 1 ? node[n][PlaceBits-1:0] : '0;
        port[n] = 2'(number[n]) & 2'(Accesses - 1);
        now[n] = reads[n] && (!Waits || 2'(number[n] >> $clog2(Accesses)) == turn);
        for (int b = 0; b < Banks; ++b) begin
          for (int r = 0; r < Reads; ++r) begin
            if (now[n] && bank[n] == bank_t'(b) && port[n] == 2'(r)) begin
              address[b][r] = address[b][r] | node[n][NodeBits-1:BankBits];
            end
          end
        end
      end
    end
    always_ff @(posedge clock) begin
      bank0 <= bank;
      bank1 <= bank0;
      port0 <= port;
      port1 <= port0;
      now0 <= now;
      now1 <= now0;
      kept <= word;
    end
    for (genvar n = 0; n < Nodes; ++n) begin : g_node
      wire [Reads-1:0][Width-1:0] of_bank = words[bank1[n]];
      assign word[n] = Waits && !now1[n] ? kept[n] : of_bank[port1[n]];
    end
  end

endmodule

`default_nettype wire
