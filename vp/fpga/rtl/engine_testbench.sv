// Replays what a run's host has written to the engine's port, and compares every clock count and
// word that comes back with those of the run: [output.engine_port] writes the file. For a simulator
// of one's own, and for the engine behind a synthesis; docs/rtl.md.
//   +port=FILE   the record
// A line of it is a letter and three hexadecimal numbers:
//   w space address word    a write
//   s clocks iterations clamped    a solve, and what it comes to
//   a clocks 0 0            a solve that is aborted after so many clocks, or a reset of an idle engine
//   e clocks 0 0            an order of the matrix editor
//   i clocks 0 0            P^-1 of all nodes
//   c clocks 0 0            x into the copies of d
//   f 0 0 0                 the next extrapolated start has no solution before x
//   x address word 0        a word of x that is read
//   z lines 0 0             the end, and how many lines come before it
`default_nettype none

module engine_testbench
  import engine_types::*;
#(
    // The size that the run had: `hvp rtl` says it. These are of the thesis'.
    parameter int Preconditioner = 1,
    parameter int MatrixBits = 12,
    parameter int VectorBits = 16,
    parameter int CoefficientBits = 16,
    parameter int Package = 8,
    parameter int Partitions = 5,
    parameter int Lanes = 2,
    parameter int NodeBits = 10,
    parameter int PackageBits = 11,
    parameter int QueueBits = 4,
    parameter int PhaseClocks = 20,
    parameter int DivisionClocks = 68,
    parameter int StaticBits = 4,
    parameter int RowsInParallel = 3,
    parameter int DirectionBanks = 1,
    parameter int DirectionMemory = 0
);

  logic clock;
  initial begin
    clock = 1'b0;
    forever #5 clock = !clock;
  end

  logic reset = 1'b0, host_write = 1'b0;
  typedef enum logic [2:0] {
    OrderGo,
    OrderCopy,
    OrderInvert,
    OrderEdit,
    OrderForget
  } order_t;
  logic [OrderForget:0] order = '0;
  space_t host_space = SpaceSettings;
  logic [31:0] host_address = '0, host_word = '0;
  wire [31:0] host_read, clamped;
  wire [15:0] iterations;
  wire [3:0] state_number;
  wire editing;
  // verilator lint_off PINCONNECTEMPTY
  engine #(
      .Preconditioner(Preconditioner),
      .MatrixBits(MatrixBits),
      .VectorBits(VectorBits),
      .CoefficientBits(CoefficientBits),
      .Package(Package),
      .Partitions(Partitions),
      .Lanes(Lanes),
      .NodeBits(NodeBits),
      .PackageBits(PackageBits),
      .QueueBits(QueueBits),
      .PhaseClocks(PhaseClocks),
      .DivisionClocks(DivisionClocks),
      .StaticBits(StaticBits),
      .RowsInParallel(RowsInParallel),
      .DirectionBanks(DirectionBanks),
      .DirectionMemory(DirectionMemory)
  ) dut (
      .clock,
      .reset,
      .host_write,
      .host_space,
      .host_address,
      .host_word,
      .host_read,
      .go(order[OrderGo]),
      .copy(order[OrderCopy]),
      .invert(order[OrderInvert]),
      .edit(order[OrderEdit]),
      .forget_previous(order[OrderForget]),
      .state_number,
      .editing,
      .finished(),
      .iteration_made(),
      .breakdown(),
      .reached(),
      .scalar_overflow(),
      .iterations_made(iterations),
      .replacements(),
      .turn_waits(),
      .room_waits(),
      .clamped,
      .alpha(),
      .alpha_exponent(),
      .beta(),
      .beta_exponent(),
      .r_exponent(),
      .d_exponent(),
      .z_exponent(),
      .z_r(),
      .d_q()
  );
  // verilator lint_on PINCONNECTEMPTY

  // Inputs change at the falling edge, and outputs are read there.
  task automatic tick();
    @(negedge clock);
  endtask

  int line = 0;
  logic ended = 1'b0;
  int compared = 0;
  int different = 0;
  task automatic expect_equal(input string what, input logic [31:0] found,
                              input logic [31:0] expected);
    ++compared;
    if (found !== expected) begin
      ++different;
      if (different == 1) begin
        $display("line %0d: %s is %h, the run has %h", line, what, found, expected);
      end
    end
  endtask

  // Behind three clocks more the memories' output registers show their first words.
  task automatic restart();
    reset = 1'b1;
    repeat (2) tick();
    reset = 1'b0;
    repeat (3) tick();
  endtask

  task automatic give(input order_t wanted);
    order[wanted] = 1'b1;
    tick();
    order = '0;
  endtask

  // Clocks until neither a solve nor an edit runs. An engine of another size may see an order without
  // an end: it is given twice the run's clocks, and as many more as a division or a pass can take.
  task automatic run(input logic [31:0] in_the_run, output logic [31:0] clocks);
    clocks = '0;
    while (state_number != InIdle || editing) begin
      if (clocks > 2 * in_the_run + 1000) begin
        $fatal(1, "line %0d: no end after %0d clocks, the run has %0d: is this its size, as ./hvp rtl prints it?",
               line, clocks, in_the_run);
      end
      tick();
      ++clocks;
    end
  endtask

  string path;
  byte letter;
  logic [31:0] first, second, third, clocks;
  initial begin
    int file;
    int fields;
    if ($value$plusargs("port=%s", path) == 0) $fatal(1, "+port=FILE was expected");
    file = $fopen(path, "r");
    if (file == 0) $fatal(1, "%s cannot be read", path);
    tick();
    restart();
    forever begin
      fields = $fscanf(file, "%c %h %h %h\n", letter, first, second, third);
      if (fields != 4) break;
      ++line;
      case (letter)
        "w": begin
          host_write = 1'b1;
          host_space = space_t'(first[3:0]);
          host_address = second;
          host_word = third;
          tick();
          host_write = 1'b0;
        end
        "s": begin
          give(OrderGo);
          run(first, clocks);
          expect_equal("a solve's number of clocks", clocks, first);
          expect_equal("a solve's number of iterations", 32'(iterations), second);
          expect_equal("the number of clamped words", clamped, third);
        end
        "a": begin
          if (first != '0) begin
            give(OrderGo);
            repeat (int'(first)) tick();
          end
          restart();
        end
        "e": begin
          repeat (3) tick();
          give(OrderEdit);
          run(first, clocks);
          expect_equal("an edit's number of clocks", clocks, first);
        end
        "i": begin
          give(OrderInvert);
          run(first, clocks);
          expect_equal("the clocks in which P^-1 is made", clocks, first);
        end
        "c": begin
          give(OrderCopy);
          run(first, clocks);
          expect_equal("a copy's number of clocks", clocks, first);
        end
        "f": give(OrderForget);
        "x": begin
          host_address = first;
          repeat (3) tick();
          expect_equal("a word of x", host_read, second);
        end
        "z": begin
          if (first != 32'(line - 1)) $fatal(1, "line %0d: the record had %0d lines before its end", line, first);
          ended = 1'b1;
        end
        default: $fatal(1, "line %0d: no letter that is known", line);
      endcase
    end
    if (fields > 0 || $feof(file) == 0) $fatal(1, "line %0d: a letter and three numbers were expected", line + 1);
    if (!ended) $fatal(1, "line %0d: the record has no end, z and its number of lines", line + 1);
    $display("%0d lines, %0d values compared, %0d of them different", line, compared, different);
    if (different != 0) $fatal(1, "the engine is not that of the run");
    if (compared == 0) $fatal(1, "nothing was compared");
    $finish;
  end

endmodule

`default_nettype wire
