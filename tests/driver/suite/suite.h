#ifndef HVP_SUITE_H
#define HVP_SUITE_H

#include "driver/user/hvp_client.h"

// The driver's tests as one program in C: against hvp_client.h alone, so that the same cases run in
// a process with the board, over a socket and in a Linux guest over its device file.

// A board to run on. What is null cannot be done there; the cases that need it are left out.
struct suite_board {
  void* context;
  hvp_status (*open)(void* context, struct hvp_client** client);
  // An access to the board's BAR beside the driver.
  uint32_t (*peek)(void* context, uint32_t offset);
  void (*poke)(void* context, uint32_t offset, uint32_t value);
  // The next wait for an interrupt is given up with this negative number.
  void (*interrupt_wait)(void* context, int number);
  // Memory that the board reaches, for a client over a bus.
  const struct hvp_dma* (*dma)(void* context);
  // Simulated time does not wait for the program: a job may end between any two of its calls.
  bool time_runs_on;
  // What the board does wrong in one of its first jobs (docs/faults.md: "stuck-busy"), or null.
  const char* fault;
};

// Runs the case of that name, or all: a line of JSON a case, with case, result (pass, fail or
// skip), the reason of the latter two, and of a case that solved what the words of U were. Returns
// how many failed; -1 where no case has that name.
int suite_run(const struct suite_board* board, const char* only);
// Their names, a line each.
void suite_list(void);

// What a command line says of it, after the program's name and what stands for the board:
// [--case NAME] [--fault KIND] [--list]; a fault alone is its case. Returns the exit status: 0, 1
// where a case failed, 2 with a line that says what was expected.
int suite_main(struct suite_board* board, int argc, char** argv);

#endif
