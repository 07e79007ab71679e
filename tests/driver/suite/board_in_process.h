#ifndef HVP_SUITE_BOARD_IN_PROCESS_H
#define HVP_SUITE_BOARD_IN_PROCESS_H

#include "tests/driver/suite/suite.h"

// The board of a scenario in this process: "SCENARIO.toml [--set KEY=VALUE]…" from the command
// line, whose number of words is returned; 0 with a line on stderr where that is no board. One a
// process.
int board_in_process(struct suite_board* board, int argc, char** argv);
void board_in_process_close(void);

#endif
