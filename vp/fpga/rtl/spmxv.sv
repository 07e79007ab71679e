// The SpMxV sub-block of thesis Fig. 5.5 in the thesis' size: three rows of eight columns a clock,
// 12-bit matrix words, 16-bit vector words, a double-pumped memory for the vector (four reads of a
// component a clock). Pipelines as accel::Architecture's defaults have them: memory read 2,
// multiplier 3, adder tree with accumulator 4.
//
// It is what vp/fpga/engine/spmxv_block.h describes; tests/vp/engine holds the two against each
// other at every clock.
`default_nettype none

module spmxv #(
    parameter int Columns = 8,        // PL2
    parameter int Nodes = 4,          // that a package touches at most
    parameter int MatrixBits = 12,
    parameter int VectorBits = 16,
    parameter int SumBits = 48,
    parameter int NodeBits = 10,
    parameter int PackageBits = 11,
    parameter int QueueBits = 4,      // rows that wait to be taken: 16
    parameter int Lanes = 2           // nodes that are written into the vector in a clock
) (
    input wire clock,
    input wire reset,

    // Host access, while idle: a word of the non-zero memory, or an entry of the index memory.
    input wire nonzero_write,
    input wire index_write,
    input wire [PackageBits-1:0] host_package,
    input wire [1:0] host_row,
    input wire [$clog2(Columns)-1:0] host_column,
    input wire signed [MatrixBits-1:0] host_word,
    input wire [Nodes-1:0][NodeBits-1:0] host_nodes,
    input wire [NodeBits-1:0] host_owner,
    input wire [1:0] host_phase,
    input wire [$clog2(Columns):0] host_columns,
    input wire host_last,
    input wire [PackageBits-1:0] packages,

    // Nodes that the vector unit has written.
    input wire [$clog2(Lanes):0] direction_count,
    input wire [NodeBits-1:0] direction_first,
    input wire [Lanes-1:0][2:0][VectorBits-1:0] direction_words,

    input wire start,
    input wire [31:0] taken,     // rows that the vector unit has taken so far
    output logic [31:0] finished,  // rows that were put into the result memory so far
    // The row that is taken next.
    output wire [NodeBits-1:0] result_node,
    output wire [2:0][SumBits-1:0] result_sum,
    output wire [2:0][VectorBits-1:0] result_own
);

  localparam int ProductBits = MatrixBits + VectorBits;

  typedef struct packed {
    logic [Nodes-1:0][NodeBits-1:0] nodes;
    logic [NodeBits-1:0] owner;
    logic [1:0] phase;  // component of the first column
    logic [$clog2(Columns):0] columns;
    logic last;
  } index_t;

  typedef struct packed {
    logic [NodeBits-1:0] node;
    logic [2:0][SumBits-1:0] sum;
    logic [2:0][VectorBits-1:0] own;
  } result_t;

  // What goes with a package through the ranks.
  typedef struct packed {
    logic valid;
    logic last;
    logic [NodeBits-1:0] owner;
    logic [2:0] caught;  // components of the row's own node that came with it
    logic [2:0][VectorBits-1:0] own;
  } tag_t;

  logic [2:0][Columns-1:0][MatrixBits-1:0] nonzeros[2**PackageBits];
  index_t index[2**PackageBits];
  logic signed [VectorBits-1:0] direction_x[2**NodeBits];
  logic signed [VectorBits-1:0] direction_y[2**NodeBits];
  logic signed [VectorBits-1:0] direction_z[2**NodeBits];
  result_t queue[2**QueueBits];

  // Memories' write ports.
  always_ff @(posedge clock) begin
    if (nonzero_write) nonzeros[host_package][host_row][host_column] <= host_word;
    if (index_write) begin
      index[host_package] <= '{
          nodes: host_nodes,
          owner: host_owner,
          phase: host_phase,
          columns: host_columns,
          last: host_last
      };
    end
    for (int lane = 0; lane < Lanes; ++lane) begin
      if (lane < int'(direction_count)) begin
        direction_x[direction_first+NodeBits'(lane)] <= direction_words[lane][0];
        direction_y[direction_first+NodeBits'(lane)] <= direction_words[lane][1];
        direction_z[direction_first+NodeBits'(lane)] <= direction_words[lane][2];
      end
    end
  end

  // A package is issued at every clock, unless it ends a row that the result memory has no room
  // for. The index memory is read ahead: its output register has the package at the position.
  logic busy;
  logic [PackageBits-1:0] position;
  logic [PackageBits-1:0] next_position;
  logic [31:0] issued_rows;
  index_t head;
  wire running = busy || start;
  wire has_room = issued_rows - taken < 32'd1 << QueueBits;
  wire issue = running && (!head.last || has_room);
  wire wraps = position + 1'b1 == packages;

  always_comb begin
    next_position = position;
    if (issue) next_position = wraps ? '0 : position + 1'b1;
  end

  always_ff @(posedge clock) begin
    head <= index[next_position];
    position <= next_position;
    busy <= running && !(issue && wraps);
    if (issue && head.last) issued_rows <= issued_rows + 1;
    if (reset) begin
      position <= '0;
      busy <= 1'b0;
      issued_rows <= '0;
    end
  end

  // Memory read: address register, output register.
  logic address_valid;
  index_t address;
  logic [PackageBits-1:0] address_package;
  logic read_valid;
  index_t read;
  logic [2:0][Columns-1:0][MatrixBits-1:0] read_nonzeros;
  logic signed [VectorBits-1:0] read_direction[3*Nodes];  // x, y, z of each node

  always_ff @(posedge clock) begin
    address_valid <= issue && !reset;
    address <= head;
    address_package <= position;
    read_valid <= address_valid && !reset;
    read <= address;
    read_nonzeros <= nonzeros[address_package];
    for (int n = 0; n < Nodes; ++n) begin
      read_direction[3*n] <= direction_x[address.nodes[n]];
      read_direction[3*n+1] <= direction_y[address.nodes[n]];
      read_direction[3*n+2] <= direction_z[address.nodes[n]];
    end
  end

  // The words of the vector that belong to the columns, and those of the row's own node.
  logic signed [VectorBits-1:0] operand[Columns];
  tag_t operand_tag;
  always_comb begin
    operand_tag = '{
        valid: read_valid,
        last: read.last,
        owner: read.owner,
        caught: '0,
        own: '0
    };
    for (int c = 0; c < Columns; ++c) begin
      automatic int word = c + int'(read.phase);
      operand[c] = read_direction[word];
      if (c < int'(read.columns) && read.nodes[word/3] == read.owner) begin
        operand_tag.caught[word%3] = 1'b1;
        operand_tag.own[word%3] = read_direction[word];
      end
    end
  end

  // Multipliers: input, pipeline and output register.
  logic signed [MatrixBits-1:0] factor_a[3][Columns];
  logic signed [VectorBits-1:0] factor_d[Columns];
  logic signed [ProductBits-1:0] product[3][Columns];
  logic signed [ProductBits-1:0] product_out[3][Columns];
  // Adder trees.
  logic signed [SumBits-1:0] quarter[3][Columns/2];
  logic signed [SumBits-1:0] half[3][Columns/4];
  logic signed [SumBits-1:0] whole[3];
  tag_t tag[6];  // beside the ranks: 0 to 2 multiplier, 3 to 5 adder tree

  always_ff @(posedge clock) begin
    for (int c = 0; c < Columns; ++c) factor_d[c] <= operand[c];
    for (int r = 0; r < 3; ++r) begin
      for (int c = 0; c < Columns; ++c) begin
        factor_a[r][c] <= read_nonzeros[r][c];
        product[r][c] <= ProductBits'(factor_a[r][c]) * ProductBits'(factor_d[c]);
        product_out[r][c] <= product[r][c];
      end
      for (int k = 0; k < Columns / 2; ++k) begin
        quarter[r][k] <= SumBits'(product_out[r][2*k]) + SumBits'(product_out[r][2*k+1]);
      end
      for (int k = 0; k < Columns / 4; ++k) begin
        half[r][k] <= quarter[r][2*k] + quarter[r][2*k+1];
      end
      whole[r] <= half[r][0] + half[r][1];
    end
    tag[0] <= operand_tag;
    for (int k = 1; k < 6; ++k) tag[k] <= tag[k-1];
    if (reset) begin
      for (int k = 0; k < 6; ++k) tag[k].valid <= 1'b0;
    end
  end

  // Accumulators; a row that is complete goes into the result memory.
  logic [2:0][SumBits-1:0] sum;
  logic [2:0][VectorBits-1:0] own;
  result_t row;
  always_comb begin
    row.node = tag[5].owner;
    for (int r = 0; r < 3; ++r) begin
      row.sum[r] = sum[r] + whole[r];
      row.own[r] = tag[5].caught[r] ? tag[5].own[r] : own[r];
    end
  end

  always_ff @(posedge clock) begin
    if (tag[5].valid) begin
      sum <= tag[5].last ? '0 : row.sum;
      own <= row.own;
      if (tag[5].last) begin
        queue[finished[QueueBits-1:0]] <= row;
        finished <= finished + 1;
      end
    end
    if (reset) begin
      sum <= '0;
      own <= '0;
      finished <= '0;
    end
  end

  wire result_t next_result = queue[taken[QueueBits-1:0]];
  assign result_node = next_result.node;
  assign result_sum = next_result.sum;
  assign result_own = next_result.own;

endmodule

`default_nettype wire
