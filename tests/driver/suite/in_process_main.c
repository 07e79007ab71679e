#include "tests/driver/suite/board_in_process.h"

// The suite on the virtual board in this process: SCENARIO.toml [--set KEY=VALUE]… and the suite's.

int main(int argc, char** argv) {
  struct suite_board board;
  const int used = board_in_process(&board, argc - 1, argv + 1);
  if (used == 0) return 2;
  const int status = suite_main(&board, argc - 1 - used, argv + 1 + used);
  board_in_process_close();
  return status;
}
