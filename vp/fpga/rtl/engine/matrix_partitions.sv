// The matrix: its partitions, the editor that changes their words, the maker of P^-1 behind it, and the
// host's writes to them.
//
// Timing is that of spmxv_partition.sv and matrix_editor.sv. The host and the editor share the
// partitions' write ports: the host waits while an order of the editor runs.
`default_nettype none

module matrix_partitions
  import engine_types::*;
#(
    parameter int Preconditioner = 0,  // of Jacobi, of blocks
    parameter int Package = 8,
    parameter int MatrixBits = 12,
    parameter int VectorBits = 16,
    parameter int SumBits = 38,
    parameter int Partitions = 5,
    parameter int Lanes = 2,
    parameter int NodeBits = 10,
    parameter int PackageBits = 11,
    parameter int BlockBits = 6,
    parameter int QueueBits = 4,
    parameter int PhaseClocks = 20,
    parameter int RowsInParallel = 3,
    parameter int DirectionBanks = 1,
    parameter int DirectionMemory = 0,
    parameter int DirectionAccesses = 4,
    parameter int DivisionClocks = 68,
    localparam int LaneBits = Lanes > 1 ? $clog2(Lanes) : 1,
    localparam int InverseWords = inverse_words(Preconditioner),
    localparam int InverseWidth = inverse_bits(Preconditioner)
) (
    input wire clock,
`ifdef ECP5
    input wire clock2,  // of the copies of d, twice as fast
`endif
    input wire reset,
    input wire host_write,
    input wire space_t host_space,
    input wire [31:0] host_address,
    input wire [31:0] host_word,
    input wire [NodeBits:0] nodes,
    input wire preconditions,
    // An order: P^-1 of all nodes, or one to the editor.
    input wire invert,
    input wire edit,
    input wire restores,
    input wire [NodeBits-1:0] edited_node,
    input wire [MatrixBits-1:0] diagonal,
    output wire editing,
    // P^-1.
    output wire inverts,
    output wire [NodeBits-1:0] inverse_node,
    output wire [1:0] inverse_component,
    output wire inverse_write,
    output wire [InverseWords-1:0][InverseWidth-1:0] inverse_new,
    input wire [InverseWords-1:0][InverseWidth-1:0] inverse_word,
    output wire [5:0] inverse_shift,
    // The sequencer and the vector unit.
    input wire product,
    input wire start,
    input wire product_ended,
    input wire [NodeBits-1:0] direction_read,
    output wire [Lanes-1:0][2:0][VectorBits-1:0] direction_words,
    input wire [Lanes-1:0] direction_write,
    input wire [NodeBits-1:0] direction_first,
    input wire [Lanes-1:0][2:0][VectorBits-1:0] direction_new,
    input wire [Partitions-1:0][QueueBits:0] taken,
    input wire [Partitions-1:0][QueueBits-1:0] behind,
    output wire [Partitions-1:0][LaneBits-1:0] behind_lane,
    output wire [Partitions-1:0][QueueBits:0] finished,
    output wire [Partitions-1:0] row_finishes,
    output wire [Partitions-1:0][NodeBits-1:0] finishing_node,
    output wire [Partitions-1:0][NodeBits-1:0] row_node,
    output wire [Partitions-1:0][2:0][SumBits-1:0] row_sum,
    output wire [Partitions-1:0][2:0][VectorBits-1:0] row_own,
    // Clocks of all partitions in which a package has waited since a solve began.
    input wire clear_waits,
    output wire [31:0] turn_waits,
    output wire [31:0] room_waits
);

  localparam int Nodes = Package % 3 == 0 ? Package / 3 : (Package + 1) / 3 + 1;
  localparam int IndexBits = (Nodes + 1) * NodeBits + 3;
  localparam int PartitionBits = Partitions > 1 ? $clog2(Partitions) : 1;

  // ---- What the host writes is collected to a row of a package, or to an index word.
  logic [Package-1:0][MatrixBits-1:0] columns;
  logic [Nodes-1:0][NodeBits-1:0] package_nodes;
  always_ff @(posedge clock) begin
    if (host_write && host_space == SpaceColumn) begin
      for (int c = 0; c < Package; ++c) begin
        if (host_address == 32'(c)) columns[c] <= host_word[MatrixBits-1:0];
      end
    end
    if (host_write && host_space == SpaceNode) begin
      for (int n = 0; n < Nodes; ++n) begin
        if (host_address == 32'(n)) package_nodes[n] <= host_word[NodeBits-1:0];
      end
    end
  end
  wire [IndexBits-1:0] index_word = {host_word[NodeBits+2:0], package_nodes};

  wire [Partitions-1:0][2:0][Package-1:0][MatrixBits-1:0] matrix_words;
  wire [Partitions-1:0][IndexBits-1:0] index_words;
  wire [Partitions-1:0][Lanes-1:0][2:0][VectorBits-1:0] copies;
  wire [PackageBits-1:0] read_package, edited_package;
  wire [Partitions-1:0] edit_write;
  wire [2:0][Package-1:0][MatrixBits-1:0] edited_words;
  // ---- P^-1.
  wire edits, edited, looks_up, look, looked;
  wire [2:0][2:0][MatrixBits-1:0] own_block;
  if (Preconditioner == 2) begin : g_blocks
    block_inverse_maker #(
        .MatrixBits(MatrixBits),
        .NodeBits(NodeBits),
        .PhaseClocks(PhaseClocks),
        .DivisionClocks(DivisionClocks)
    ) maker (
        .clock,
        .reset,
        .nodes,
        .all(invert),
        .one(edited && preconditions),
        .edited_node,
        .busy(inverts),
        .inverts_all(looks_up),
        .look,
        .node(inverse_node),
        .looked,
        .own_block,
        .component(inverse_component),
        .write(inverse_write),
        .words(inverse_new),
        .old_words(inverse_word),
        .shift(inverse_shift)
    );
  end else if (Preconditioner == 1) begin : g_preconditioner
    inverse_maker #(
        .MatrixBits(MatrixBits),
        .NodeBits(NodeBits),
        .PhaseClocks(PhaseClocks),
        .DivisionClocks(DivisionClocks)
    ) maker (
        .clock,
        .reset,
        .nodes,
        .all(invert),
        .one(edited && preconditions),
        .edited_node,
        .busy(inverts),
        .inverts_all(looks_up),
        .look,
        .node(inverse_node),
        .looked,
        .diagonal({own_block[2][2], own_block[1][1], own_block[0][0]}),
        .component(inverse_component),
        .write(inverse_write),
        .word(inverse_new),
        .old_word(inverse_word),
        .shift(inverse_shift)
    );
    wire unused_words = &{1'b0, own_block};
  end else begin : g_none
    assign inverts = 1'b0;
    assign looks_up = 1'b0;
    assign look = 1'b0;
    assign inverse_node = '0;
    assign inverse_component = '0;
    assign inverse_write = 1'b0;
    assign inverse_new = '0;
    assign inverse_shift = '0;
    wire unused_preconditioner = &{1'b0, nodes, preconditions, invert, edited, looked, own_block,
                                   inverse_word};
  end
  assign editing = edits || inverts;

  matrix_editor #(
      .Package(Package),
      .MatrixBits(MatrixBits),
      .Partitions(Partitions),
      .NodeBits(NodeBits),
      .PackageBits(PackageBits),
      .BlockBits(BlockBits),
      .PhaseClocks(PhaseClocks)
  ) editor (
      .clock,
      .reset,
      .place_write(host_write && host_space == SpacePlace),
      .place_node(host_address[NodeBits-1:0]),
      .place_word({host_word[24+:BlockBits+1], host_address[23:16], host_word[16+:PartitionBits],
                   host_word[PackageBits-1:0]}),
      .contact_write(host_write && host_space == SpaceContact),
      .contact_node(host_address[NodeBits-1:0]),
      .contact_word(host_word[0]),
      .staged_write(host_write && host_space == SpaceStaged),
      .staged_block(host_address[4+:BlockBits]),
      .staged_entry(host_address[3:0]),
      .staged_word(host_word[MatrixBits-1:0]),
      .start(edit || look),
      .look,
      .restores,
      .node(looks_up ? inverse_node : edited_node),
      .diagonal,
      .busy(edits),
      .over(edited),
      .looked,
      .own_block,
      .read_package,
      .words(matrix_words),
      .index(index_words),
      .write(edit_write),
      .write_package(edited_package),
      .new_words(edited_words)
  );
  wire [Partitions-1:0] waits_for_turns, waits_for_room;
  for (genvar p = 0; p < Partitions; ++p) begin : g_partition
    wire here = host_write && host_address[31:16] == 16'(p);
    wire [2:0] rows;
    assign rows[0] = here && host_space == SpaceMatrix && host_address[15:14] == 2'd0;
    assign rows[1] = here && host_space == SpaceMatrix && host_address[15:14] == 2'd1;
    assign rows[2] = here && host_space == SpaceMatrix && host_address[15:14] == 2'd2;
    logic [PackageBits:0] packages;
    wire packages_write = here && host_space == SpacePackages;
    always_ff @(posedge clock) begin
      if (packages_write) packages <= host_word[PackageBits:0];
    end
    spmxv_partition #(
        .Package(Package),
        .MatrixBits(MatrixBits),
        .VectorBits(VectorBits),
        .SumBits(SumBits),
        .NodeBits(NodeBits),
        .PackageBits(PackageBits),
        .QueueBits(QueueBits),
        .Lanes(Lanes),
        .RowsInParallel(RowsInParallel),
        .DirectionBanks(DirectionBanks),
        .DirectionMemory(DirectionMemory),
        .DirectionAccesses(DirectionAccesses)
    ) spmxv (
        .clock,
`ifdef ECP5
        .clock2,
`endif
        .reset(reset || product_ended),
        .matrix_write(rows | {3{edit_write[p]}}),
        .matrix_write_package(edit_write[p] ? edited_package : host_address[PackageBits-1:0]),
        .matrix_write_words(edit_write[p] ? edited_words : {3{columns}}),
        .index_write(here && host_space == SpaceIndex),
        .index_write_package(host_address[PackageBits-1:0]),
        .index_write_word(index_word),
        .packages,
        .packages_write,
        .edits(editing),
        .edited_package(read_package),
        .matrix_words(matrix_words[p]),
        .index_word(index_words[p]),
        .product,
        .start,
        .direction_read,
        .direction_words(copies[p]),
        .direction_write,
        .direction_first,
        .direction_new,
        .taken(taken[p]),
        .behind(behind[p]),
        .behind_lane(behind_lane[p]),
        .finished(finished[p]),
        .row_finishes(row_finishes[p]),
        .finishing_node(finishing_node[p]),
        .row_node(row_node[p]),
        .row_sum(row_sum[p]),
        .row_own(row_own[p]),
        .waits_for_turns(waits_for_turns[p]),
        .waits_for_room(waits_for_room[p])
    );
  end

  // ---- Counters.
  localparam int CountBits = $clog2(Partitions + 1);
  logic [CountBits-1:0] turns, turns_now, rooms, rooms_now;
  always_comb begin
    turns = '0;
    rooms = '0;
    for (int p = 0; p < Partitions; ++p) begin
      turns = turns + CountBits'(waits_for_turns[p]);
      rooms = rooms + CountBits'(waits_for_room[p]);
    end
  end
  // With those of the edge before: a solve may end with a product in which packages wait to its end,
  // where an index word has flipped.
  logic [31:0] turns_before, rooms_before;
  assign turn_waits = turns_before + 32'(turns_now);
  assign room_waits = rooms_before + 32'(rooms_now);
  always_ff @(posedge clock) begin
    turns_now <= turns;
    rooms_now <= rooms;
    turns_before <= clear_waits ? '0 : turn_waits;
    rooms_before <= clear_waits ? '0 : room_waits;
    if (clear_waits || reset) begin
      turns_now <= '0;
      rooms_now <= '0;
    end
  end

  // The copies agree: a pass reads the first one.
  assign direction_words = copies[0];
  wire unused = &{1'b0, copies, host_word};

endmodule

`default_nettype wire
