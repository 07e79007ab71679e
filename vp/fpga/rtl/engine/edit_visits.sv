// Which packages the matrix editor has to look at, one a clock where it can be: those of the edited
// node's own row, then those of each neighbour's (thesis section 6.2.1; engine::MatrixEditor::begin).
//
// The neighbours are the block columns of the own row's index words. They come two clocks behind a
// visit and wait in a memory; each takes a clock to be looked up in the table of places, so that the
// visits have a gap of some clocks behind the own row, and none later.
`default_nettype none

module edit_visits #(
    parameter int Package = 8,
    parameter int Partitions = 5,
    parameter int NodeBits = 10,
    parameter int PackageBits = 11,
    parameter int BlockBits = 6,       // 2^BlockBits blocks of a row at most
    localparam int Nodes = Package % 3 == 0 ? Package / 3 : (Package + 1) / 3 + 1,
    localparam int PartitionBits = Partitions > 1 ? $clog2(Partitions) : 1,
    // {blocks, packages, partition, first package}
    localparam int PlaceBits = BlockBits + 1 + 8 + PartitionBits + PackageBits
) (
    input wire clock,
    input wire reset,
    input wire place_write,
    input wire [NodeBits-1:0] place_node,
    input wire [PlaceBits-1:0] place_word,
    input wire start,
    input wire own_only,  // nobody's row but the node's own
    input wire [NodeBits-1:0] node,  // still from three clocks before `start`
    output logic busy,               // visits are left
    // A visit: the package, the row it belongs to, and of that row the block and how many columns
    // are from here to its end. For a neighbour's row `block` is that row's block in the own row.
    output logic visit,
    output logic [PartitionBits-1:0] visit_partition,
    output logic [PackageBits-1:0] visit_package,
    output logic [NodeBits-1:0] visit_row,
    output logic visit_own,
    output logic [BlockBits-1:0] visit_block,
    output logic [BlockBits+2:0] visit_columns,
    // The index word of a visit to the own row.
    input wire index_valid,
    input wire [1:0] index_phase,
    input wire [Nodes-1:0][NodeBits-1:0] index_nodes
);

  localparam int P = PackageBits;
  localparam int QueueBits = BlockBits;  // as many packages as blocks: no fewer than three columns
  localparam int CountBits = $clog2(Nodes + 1);

  // Its node holds still while a word could be read that is just written.
  (* no_rw_check *) logic [PlaceBits-1:0] places[2**NodeBits];
  logic [PlaceBits-1:0] place;
  logic [BlockBits+2:0] own_columns;  // of the row at `place`, a clock later

  // ---- The own row's index words, until their nodes are looked up.
  // In look-up tables, as all that decides about the next look follows on a word: a tool takes a
  // block RAM where it is not too wide for one, and that takes half of a clock.
  (* ram_style = "distributed" *) logic [Nodes*NodeBits+1:0] words[2**QueueBits];
  logic [QueueBits-1:0] put, got;
  wire [Nodes*NodeBits+1:0] word = words[got];
  wire [1:0] phase = word[Nodes*NodeBits+:2];

  // ---- Scanning: node `index` of the word is a block of its own unless it began in the word before.
  logic scanning;
  logic scanned_any;  // of this word
  logic [CountBits-1:0] next_index;
  logic [BlockBits:0] scanned, blocks;
  wire [CountBits-1:0] index = scanned_any ? next_index : CountBits'(phase != 2'd0);
  logic [NodeBits-1:0] neighbour;
  always_comb begin
    neighbour = '0;
    for (int n = 0; n < Nodes; ++n) begin
      if (index == CountBits'(n)) neighbour = word[n*NodeBits+:NodeBits];
    end
  end
  // Its first column is in the package: 3 index - phase < Package.
  function automatic logic in_package(input int number, input logic [1:0] phase_of_word);
    in_package = 1'b0;
    for (int n = 0; n < Nodes; ++n) begin
      if (number == n && 3 * n < int'(phase_of_word) + Package) in_package = 1'b1;
    end
  endfunction
  wire there = in_package(int'(index), phase);
  wire next_there = in_package(int'(index) + 1, phase);
  wire has_word = scanning && put != got;
  wire looks = has_word && there && scanned != blocks;

  // ---- Behind it, each with a neighbour of its own: it is found, its place is read, and it is the next
  // row.
  logic found_valid, read_valid, next_valid;
  logic [NodeBits-1:0] found_node, read_node, next_node;
  logic [BlockBits-1:0] found_block, read_block, next_block;
  logic [PlaceBits-1:0] next_place;
  // ---- The row whose packages are visited.
  logic current_valid, current_own;
  logic [NodeBits-1:0] current_node;
  logic [BlockBits-1:0] current_block;
  logic [1:0] current_phase;
  logic [BlockBits+2:0] current_columns;
  logic [7:0] left;
  logic [PartitionBits-1:0] current_partition;
  logic [P-1:0] current_package;

  wire last = left == 8'd1;
  wire takes_next = next_valid && (!current_valid || last);
  wire takes_read = read_valid && (!next_valid || takes_next);
  wire takes_found = !read_valid || takes_read;
  wire takes_scanned = !found_valid || takes_found;
  wire [NodeBits-1:0] place_address = busy ? found_node : node;

  function automatic logic [BlockBits+2:0] columns_of(input logic [BlockBits:0] count);
    return {1'b0, count, 1'b0} + {2'b00, count};
  endfunction

  // A package further: its first block and component.
  wire [2:0] next_phase = {1'b0, current_phase} + 3'(Package % 3);
  wire carries = next_phase >= 3'd3;
  wire [1:0] phase_now = carries ? 2'(next_phase - 3'd3) : next_phase[1:0];

  always_ff @(posedge clock) begin
    if (place_write) places[place_node] <= place_word;
    own_columns <= columns_of(place[PlaceBits-1-:BlockBits+1]);
    if (!busy || takes_found) place <= places[place_address];

    if (index_valid) begin
      words[put] <= {index_phase, index_nodes};
      put <= put + 1'b1;
    end

    if (takes_scanned) begin
      found_valid <= looks;
      found_node <= neighbour;
      found_block <= scanned[BlockBits-1:0];
      if (has_word) begin
        if (looks) begin
          scanned <= scanned + 1'b1;
          next_index <= index + 1'b1;
          scanned_any <= 1'b1;
        end
        if (!looks || !next_there) begin
          got <= got + 1'b1;
          scanned_any <= 1'b0;
        end
      end
      if (scanned == blocks) scanning <= 1'b0;
    end
    if (takes_found) begin
      read_valid <= found_valid && found_node != node;
      read_node <= found_node;
      read_block <= found_block;
    end
    if (takes_read) begin
      next_node <= read_node;
      next_block <= read_block;
      next_place <= place;
    end
    next_valid <= takes_read || (next_valid && !takes_next);

    visit <= current_valid;
    visit_partition <= current_partition;
    visit_package <= current_package;
    visit_row <= current_node;
    visit_own <= current_own;
    visit_block <= current_block;
    visit_columns <= current_columns;
    if (current_valid) begin
      left <= left - 1'b1;
      current_package <= current_package + 1'b1;
      current_columns <=
          current_columns > (BlockBits + 3)'(Package) ? current_columns - (BlockBits + 3)'(Package)
                                                      : '0;
      current_phase <= phase_now;
      if (current_own) current_block <= current_block + BlockBits'(Package / 3) + BlockBits'(carries);
      if (last) current_valid <= 1'b0;
    end
    if (takes_next) begin
      current_valid <= 1'b1;
      current_own <= 1'b0;
      current_node <= next_node;
      current_block <= next_block;
      current_columns <= columns_of(next_place[PlaceBits-1-:BlockBits+1]);
      {left, current_partition, current_package} <= next_place[PartitionBits+P+7:0];
    end
    if (busy && !scanning && !found_valid && !read_valid && !next_valid && !current_valid) busy <= 1'b0;

    if (start) begin
      busy <= 1'b1;
      scanning <= !own_only;
      scanned <= '0;
      scanned_any <= 1'b0;
      blocks <= place[PlaceBits-1-:BlockBits+1];
      put <= '0;
      got <= '0;
      found_valid <= 1'b0;
      read_valid <= 1'b0;
      next_valid <= 1'b0;
      current_valid <= 1'b1;
      current_own <= 1'b1;
      current_node <= node;
      current_block <= '0;
      current_phase <= '0;
      current_columns <= own_columns;
      {left, current_partition, current_package} <= place[PartitionBits+P+7:0];
    end
    if (reset) begin
      busy <= 1'b0;
      scanning <= 1'b0;
      found_valid <= 1'b0;
      read_valid <= 1'b0;
      next_valid <= 1'b0;
      current_valid <= 1'b0;
      visit <= 1'b0;
    end
  end

endmodule

`default_nettype wire
