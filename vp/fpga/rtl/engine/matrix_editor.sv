// Clears the row and the column of a contact node but for its diagonal, or restores them from a row
// that the host has sent (engine::MatrixEditor; thesis sections 3.7 and 6.2.1).
//
// A package goes through three ranks: its memories are read (two), its words are changed, and it is
// written back. An order takes the clocks of its visits, one a package, and PhaseClocks more. Each tells
// the diagonal of the node's row, which `look` only reads.
`default_nettype none

module matrix_editor #(
    parameter int Package = 8,
    parameter int MatrixBits = 12,
    parameter int Partitions = 5,
    parameter int NodeBits = 10,
    parameter int PackageBits = 11,
    parameter int BlockBits = 6,
    parameter int PhaseClocks = 20,
    localparam int Nodes = Package % 3 == 0 ? Package / 3 : (Package + 1) / 3 + 1,
    localparam int IndexBits = (Nodes + 1) * NodeBits + 3,
    localparam int PartitionBits = Partitions > 1 ? $clog2(Partitions) : 1,
    localparam int PlaceBits = BlockBits + 1 + 8 + PartitionBits + PackageBits
) (
    input wire clock,
    input wire reset,
    // The host's port.
    input wire place_write,
    input wire [NodeBits-1:0] place_node,
    input wire [PlaceBits-1:0] place_word,
    input wire contact_write,
    input wire [NodeBits-1:0] contact_node,
    input wire contact_word,
    input wire staged_write,  // a word of a block, or with entry 15 the block that they make
    input wire [BlockBits-1:0] staged_block,
    input wire [3:0] staged_entry,
    input wire [MatrixBits-1:0] staged_word,
    // An order: the registers hold still from three clocks before.
    input wire start,
    input wire look,  // the own row is read and stays as it is
    input wire restores,
    input wire [NodeBits-1:0] node,
    input wire [MatrixBits-1:0] diagonal,
    output logic busy,
    output wire over,          // with the next edge it is busy no more
    output wire looked,        // the order to look is over
    output logic [2:0][MatrixBits-1:0] diagonal_words,
    // The partitions' memories.
    output wire [PackageBits-1:0] read_package,
    input wire [Partitions-1:0][2:0][Package-1:0][MatrixBits-1:0] words,
    input wire [Partitions-1:0][IndexBits-1:0] index,
    output logic [Partitions-1:0] write,
    output logic [PackageBits-1:0] write_package,
    output logic [2:0][Package-1:0][MatrixBits-1:0] new_words
);

  localparam int ColumnBits = BlockBits + 3;
  localparam int BankBits = Nodes > 4 ? 3 : 2;  // a package touches no more blocks
  localparam int Banks = 2 ** BankBits;

  // ---- Contact nodes, one bit each: looked up for every column of a package.
  logic contact[2**NodeBits];
  always_ff @(posedge clock) begin
    if (start && !look) contact[node] <= !restores;
    else if (contact_write) contact[contact_node] <= contact_word;
  end

  // ---- The row that comes back: block i is in memory i mod Banks.
  logic [8:0][MatrixBits-1:0] block_words;
  logic [BlockBits-1:0] first_block;
  wire [Banks-1:0][8:0][MatrixBits-1:0] staged;
  always_ff @(posedge clock) begin
    if (staged_write) begin
      for (int e = 0; e < 9; ++e) if (staged_entry == 4'(e)) block_words[e] <= staged_word;
    end
  end
  for (genvar b = 0; b < Banks; ++b) begin : g_bank
    logic [9*MatrixBits-1:0] cells[2**(BlockBits-BankBits)];
    always_ff @(posedge clock) begin
      if (staged_write && staged_entry == 4'd15 && staged_block[BankBits-1:0] == BankBits'(b)) begin
        cells[staged_block[BlockBits-1:BankBits]] <= block_words;
      end
    end
    // Of Banks blocks from the first one: that which this memory has.
    wire [BlockBits-1:0] ahead = first_block + BlockBits'(Banks - 1 - b);
    assign staged[b] = cells[ahead[BlockBits-1:BankBits]];
    wire unused = &{1'b0, ahead[BankBits-1:0]};
  end

  // ---- An order.
  logic looks;
  always_ff @(posedge clock) begin
    if (start) looks <= look;
    else if (looked || reset) looks <= 1'b0;
  end

  // ---- Visits. Ranks: the address, the memories' registers, and the words.
  wire visits_left, visit, visit_own;
  wire [PartitionBits-1:0] visit_partition;
  wire [NodeBits-1:0] visit_row;
  wire [BlockBits-1:0] visit_block;
  wire [ColumnBits-1:0] visit_columns;
  logic [2:1] valid, own;
  logic [PartitionBits-1:0] partition[1:2];
  logic [PackageBits-1:0] package_at[1:2];
  logic [NodeBits-1:0] row[1:2];
  logic [BlockBits-1:0] block[1:2];
  logic [ColumnBits-1:0] columns[1:2];
  wire [IndexBits-1:0] index2 = index[partition[2]];
  wire [1:0] phase2 = index2[IndexBits-2-:2];
  wire [Nodes-1:0][NodeBits-1:0] nodes2 = index2[Nodes*NodeBits-1:0];
  edit_visits #(
      .Package(Package),
      .Partitions(Partitions),
      .NodeBits(NodeBits),
      .PackageBits(PackageBits),
      .BlockBits(BlockBits)
  ) visits (
      .clock,
      .reset,
      .place_write,
      .place_node,
      .place_word,
      .start,
      .own_only(look),
      .node,
      .busy(visits_left),
      .visit,
      .visit_partition,
      .visit_package(read_package),
      .visit_row,
      .visit_own,
      .visit_block,
      .visit_columns,
      .index_valid(valid[2] && own[2]),
      .index_phase(phase2),
      .index_nodes(nodes2)
  );
  always_ff @(posedge clock) begin
    valid <= {valid[1], visit};
    own <= {own[1], visit_own};
    partition[1] <= visit_partition;
    package_at[1] <= read_package;
    row[1] <= visit_row;
    block[1] <= visit_block;
    columns[1] <= visit_columns;
    partition[2] <= partition[1];
    package_at[2] <= package_at[1];
    row[2] <= row[1];
    block[2] <= block[1];
    columns[2] <= columns[1];
    if (reset) valid <= '0;
  end

  wire unused = &{1'b0, index2[IndexBits-1], index2[Nodes*NodeBits+:NodeBits]};

  // ---- The words that are changed. Column c is component (phase + c) mod 3 of node (phase + c) / 3.
  assign first_block = block[2];
  wire row_is_contact = contact[row[2]];
  logic [Nodes-1:0] node_is_contact;
  always_comb for (int n = 0; n < Nodes; ++n) node_is_contact[n] = contact[nodes2[n]];

  // The block of the own row that node n of the package is; a neighbour's row has one block there.
  logic [Nodes-1:0][8:0][MatrixBits-1:0] block_of;
  always_comb begin
    for (int n = 0; n < Nodes; ++n) begin
      automatic logic [BankBits-1:0] bank = block[2][BankBits-1:0] + (own[2] ? BankBits'(n) : '0);
      block_of[n] = staged[bank];
    end
  end

  // What becomes of node n's words: they are cleared or restored, or stay.
  logic [Nodes-1:0] is_node, touched;
  always_comb begin
    for (int n = 0; n < Nodes; ++n) begin
      is_node[n] = nodes2[n] == node;
      touched[n] = looks ? 1'b0 : own[2] ? is_node[n] || !(restores && node_is_contact[n])
                          : is_node[n] && !(restores && row_is_contact);
    end
  end
  // The word of row r and component k of node n.
  function automatic logic [MatrixBits-1:0] word_of(input logic [8:0][MatrixBits-1:0] from,
                                                    input logic of_node, input int r,
                                                    input int k);
    if (restores) return own[2] ? from[3*r+k] : from[3*k+r];
    return own[2] && of_node && r == k ? diagonal : '0;
  endfunction

  // Column c is a component of a node for each of the three phases.
  for (genvar c = 0; c < Package; ++c) begin : g_column
    localparam int Node0 = c / 3;
    localparam int Node1 = (c + 1) / 3 < Nodes ? (c + 1) / 3 : Nodes - 1;
    localparam int Node2 = (c + 2) / 3 < Nodes ? (c + 2) / 3 : Nodes - 1;  // the phase is 0 then
    for (genvar r = 0; r < 3; ++r) begin : g_row
      always_ff @(posedge clock) begin
        if (valid[2]) begin
          new_words[r][c] <= words[partition[2]][r][c];
          if (ColumnBits'(c) < columns[2]) begin
            case (phase2)
              2'd0:
              if (touched[Node0]) begin
                new_words[r][c] <= word_of(block_of[Node0], is_node[Node0], r, c % 3);
              end
              2'd1:
              if (touched[Node1]) begin
                new_words[r][c] <= word_of(block_of[Node1], is_node[Node1], r, (c + 1) % 3);
              end
              default:
              if (touched[Node2]) begin
                new_words[r][c] <= word_of(block_of[Node2], is_node[Node2], r, (c + 2) % 3);
              end
            endcase
          end
        end
      end
    end
  end
  always_ff @(posedge clock) begin
    for (int p = 0; p < Partitions; ++p) begin
      write[p] <= valid[2] && partition[2] == PartitionBits'(p) && !looks && !reset;
    end
    write_package <= package_at[2];
  end

  // ---- The diagonal of the own row, as its words are behind rank 2.
  logic valid3;
  logic [Package-1:0] on_diagonal3;  // columns of the node's own block
  logic [1:0] phase3;
  always_ff @(posedge clock) begin
    valid3 <= valid[2] && !reset;
    phase3 <= phase2;
  end
  for (genvar c = 0; c < Package; ++c) begin : g_diagonal
    localparam int Node0 = c / 3;
    localparam int Node1 = (c + 1) / 3 < Nodes ? (c + 1) / 3 : Nodes - 1;
    localparam int Node2 = (c + 2) / 3 < Nodes ? (c + 2) / 3 : Nodes - 1;
    wire of_node = phase2 == 2'd0 ? is_node[Node0] : phase2 == 2'd1 ? is_node[Node1] : is_node[Node2];
    always_ff @(posedge clock) begin
      on_diagonal3[c] <= valid[2] && own[2] && ColumnBits'(c) < columns[2] && of_node;
    end
  end
  always_ff @(posedge clock) begin
    for (int r = 0; r < 3; ++r) begin
      for (int c = 0; c < Package; ++c) begin
        if (on_diagonal3[c] && 2'(r) == (phase3 == 2'd0 ? 2'(c % 3) : phase3 == 2'd1
                                         ? 2'((c + 1) % 3) : 2'((c + 2) % 3))) begin
          diagonal_words[r] <= new_words[r][c];
        end
      end
    end
  end
  assign looked = looks && !visits_left && !visit && valid == '0 && !valid3;

  // ---- The clocks of an order: its visits, then PhaseClocks. The gap behind the own row, and the
  // ranks behind the last visit, are shorter than that.
  logic [15:0] visited, elapsed;
  wire [15:0] elapsed_now = elapsed + 1'b1;
  assign over =
      busy && !visits_left && !visit && elapsed_now == visited + 16'(PhaseClocks);
  always_ff @(posedge clock) begin
    if (busy) elapsed <= elapsed_now;
    if (visit) visited <= visited + 1'b1;
    if (over) busy <= 1'b0;
    if (start && !look) begin
      busy <= 1'b1;
      visited <= '0;
      elapsed <= '0;
    end
    if (reset) busy <= 1'b0;
  end

endmodule

`default_nettype wire
