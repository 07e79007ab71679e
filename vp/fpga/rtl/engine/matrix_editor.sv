// Clears the row and the column of a contact node but for its diagonal, or restores them from a row
// that the host has sent (engine::MatrixEditor; thesis sections 3.7 and 6.2.1).
//
// A package goes through five ranks: its memories are read (two), its nodes are looked up among the
// contacts, what becomes of them is decided, its words are changed, and it is written back. An order takes the clocks of its visits, one a package, and PhaseClocks more. Each tells
// the node's own block, which `look` only reads.
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
    output logic [2:0][2:0][MatrixBits-1:0] own_block,  // rows of columns
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

  // ---- Contact nodes, one bit each, in as many memories as the nodes of a package and the row need
  // ports. All are written at the same edge, through the first port.
  localparam int Contacts = (Nodes + 2) / 2;
  wire contact_writes = contact_write || (start && !look);
  wire [NodeBits-1:0] contact_written = start && !look ? node : contact_node;
  wire contact_new = start && !look ? !restores : contact_word;
  logic [2*Contacts-1:0][NodeBits-1:0] contact_read;
  wire [2*Contacts-1:0] is_contact3;
  for (genvar i = 0; i < Contacts; ++i) begin : g_contact
    wire [1:0][NodeBits-1:0] address = {
      contact_read[2*i+1], contact_writes ? contact_written : contact_read[2*i]
    };
    dual_port_memory #(
        .Width(1),
        .AddressBits(NodeBits)
    ) memory (
        .clock,
        .write({1'b0, contact_writes}),
        .address,
        .write_word({1'b0, contact_new}),
        .word(is_contact3[2*i+:2])
    );
  end

  // ---- The row that comes back: block i is in memory i mod Banks.
  logic [8:0][MatrixBits-1:0] block_words;
  logic [BlockBits-1:0] first_block;  // a rank before its words
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
    logic [BlockBits-BankBits-1:0] address3;
    always_ff @(posedge clock) address3 <= ahead[BlockBits-1:BankBits];
    assign staged[b] = cells[address3];
    wire unused = &{1'b0, ahead[BankBits-1:0]};
  end

  // ---- An order.
  logic looks;
  always_ff @(posedge clock) begin
    if (start) looks <= look;
    else if (looked || reset) looks <= 1'b0;
  end

  // ---- Visits. Ranks: the address, the memories' registers, the nodes, and the words.
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

  // ---- Rank 3: the partition's words, and which nodes are contacts. Rank 4: what becomes of each node's
  // words, and the own row's blocks.
  always_comb begin
    contact_read = '0;
    for (int n = 0; n < Nodes; ++n) contact_read[n] = nodes2[n];
    contact_read[Nodes] = row[2];
  end
  logic valid3, valid4, own3, own4;
  logic [1:0] phase3, phase4;
  logic [PartitionBits-1:0] partition3, partition4;
  logic [PackageBits-1:0] package3, package4;
  logic [BankBits-1:0] bank3;  // of the first block
  assign first_block = block[2];
  logic [ColumnBits-1:0] columns3, columns4;
  logic [2:0][Package-1:0][MatrixBits-1:0] words3, words4;
  logic [Nodes-1:0] is_node3, is_node;
  // The block of the own row that node n of the package is; a neighbour's row has one block there,
  // which is its transpose.
  logic [Nodes-1:0][8:0][MatrixBits-1:0] block_of;
  // What becomes of column c, which is component (phase + c) mod 3 of node (phase + c) / 3: its words
  // stay, or they are those of a block with one of the three phases, or the diagonal, or zero. They do
  // not stay in any case, or unless a contact wants them to: the node or, in another row, that row's.
  logic [2:0][Package-1:0] touched3, touched4, unless_contact3, unless_contact4;  // with a phase each
  logic [2:0][Package-1:0] changed4;
  logic [Nodes-1:0] is_contact4;
  logic [2:0][Package-1:0] has_diagonal3, has_diagonal4;  // of a row each
  for (genvar c = 0; c < Package; ++c) begin : g_touched
    wire here = ColumnBits'(c) < columns3 && !looks;
    for (genvar i = 0; i < 3; ++i) begin : g_phase
      localparam int Node = (c + i) / 3 < Nodes ? (c + i) / 3 : Nodes - 1;
      wire in_phase = here && (i == 2 ? phase3[1] : phase3 == 2'(i));
      wire of_node = in_phase && is_node3[Node];
      assign touched3[i][c] = own3 ? of_node || (in_phase && !restores) : of_node && !restores;
      assign unless_contact3[i][c] = own3 ? in_phase : of_node;
      assign changed4[i][c] = touched4[i][c] || (unless_contact4[i][c] && !is_contact4[Node]);
      assign has_diagonal3[(c+i)%3][c] = own3 && of_node && !restores;
    end
  end
  always_ff @(posedge clock) begin
    valid3 <= valid[2] && !reset;
    own3 <= own[2];
    phase3 <= phase2;
    partition3 <= partition[2];
    package3 <= package_at[2];
    bank3 <= block[2][BankBits-1:0];
    columns3 <= columns[2];
    words3 <= words[partition[2]];
    valid4 <= valid3 && !reset;
    own4 <= own3;
    phase4 <= phase3;
    partition4 <= partition3;
    package4 <= package3;
    columns4 <= columns3;
    words4 <= words3;
    is_node <= is_node3;
    touched4 <= touched3;
    unless_contact4 <= unless_contact3;
    for (int n = 0; n < Nodes; ++n) is_contact4[n] <= is_contact3[own3 ? n : Nodes];
    has_diagonal4 <= has_diagonal3;
    for (int n = 0; n < Nodes; ++n) begin
      automatic logic [BankBits-1:0] bank = bank3 + (own3 ? BankBits'(n) : '0);
      is_node3[n] <= nodes2[n] == node;
      for (int r = 0; r < 3; ++r) begin
        for (int k = 0; k < 3; ++k) begin
          block_of[n][3*r+k] <= own3 ? staged[bank][3*r+k] : staged[bank][3*k+r];
        end
      end
    end
  end

  // ---- The words that are changed.
  for (genvar c = 0; c < Package; ++c) begin : g_column
    localparam int Node0 = c / 3;
    localparam int Node1 = (c + 1) / 3 < Nodes ? (c + 1) / 3 : Nodes - 1;
    localparam int Node2 = (c + 2) / 3 < Nodes ? (c + 2) / 3 : Nodes - 1;  // the phase is 0 then
    for (genvar r = 0; r < 3; ++r) begin : g_row
      logic [MatrixBits-1:0] chosen;
      always_comb begin
        chosen = changed4[0][c] || changed4[1][c] || changed4[2][c] ? '0 : words4[r][c];
        if (has_diagonal4[r][c]) chosen = chosen | diagonal;
        if (restores && changed4[0][c]) chosen = chosen | block_of[Node0][3*r+c%3];
        if (restores && changed4[1][c]) chosen = chosen | block_of[Node1][3*r+(c+1)%3];
        if (restores && changed4[2][c]) chosen = chosen | block_of[Node2][3*r+(c+2)%3];
      end
      always_ff @(posedge clock) if (valid4) new_words[r][c] <= chosen;
    end
  end
  always_ff @(posedge clock) begin
    for (int p = 0; p < Partitions; ++p) begin
      write[p] <= valid4 && partition4 == PartitionBits'(p) && !looks && !reset;
    end
    write_package <= package4;
  end

  // ---- The own block, as its words are behind rank 4: a component of the node is one column of a
  // package at most.
  logic valid5;
  logic [2:0][Package-1:0] is_component5;
  logic [2:0] has_component5;
  logic [2:0][Package-1:0] is_component4;
  for (genvar c = 0; c < Package; ++c) begin : g_diagonal
    localparam int Node0 = c / 3;
    localparam int Node1 = (c + 1) / 3 < Nodes ? (c + 1) / 3 : Nodes - 1;
    localparam int Node2 = (c + 2) / 3 < Nodes ? (c + 2) / 3 : Nodes - 1;
    wire here = valid4 && own4 && ColumnBits'(c) < columns4;
    for (genvar k = 0; k < 3; ++k) begin : g_component
      // The phase with which column c is component k.
      localparam int Phase = (k - c + 3 * Package) % 3;
      localparam int Node = Phase == 0 ? Node0 : Phase == 1 ? Node1 : Node2;
      wire in_phase = Phase == 2 ? phase4[1] : phase4 == 2'(Phase);
      assign is_component4[k][c] = here && in_phase && is_node[Node];
    end
  end
  always_ff @(posedge clock) begin
    valid5 <= valid4 && !reset;
    is_component5 <= is_component4;
    for (int k = 0; k < 3; ++k) has_component5[k] <= |is_component4[k];
  end
  for (genvar k = 0; k < 3; ++k) begin : g_own
    for (genvar r = 0; r < 3; ++r) begin : g_row
      logic [MatrixBits-1:0] chosen;
      always_comb begin
        chosen = '0;
        for (int c = 0; c < Package; ++c) begin
          if (is_component5[k][c]) chosen = chosen | new_words[r][c];
        end
      end
      always_ff @(posedge clock) if (has_component5[k]) own_block[r][k] <= chosen;
    end
  end
  assign looked = looks && !visits_left && !visit && valid == '0 && !valid3 && !valid4 && !valid5;

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
