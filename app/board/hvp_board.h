#ifndef HVP_BOARD_H
#define HVP_BOARD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "driver/hvp_driver.h"

// The board of a scenario in a program of your own (docs/first-driver.md): a driver that is being
// written runs here, in simulated time, before there is a board. No thread is started and none of
// the functions is to be called from two. SystemC elaborates once in a process, so that a process
// has one board, once.
#ifdef __cplusplus
extern "C" {
#endif

// C's names.
// NOLINTBEGIN(readability-identifier-naming)
struct hvp_board;

struct hvp_board_options {
  const char* const* overrides;  // "key=value", as `hvp run --set` has them
  size_t override_count;
  // A folder for registers.log and registers.vcd, as `hvp run --trace-registers` writes them; they
  // have their names when the board is closed. Null: none.
  const char* trace;
};

// The board of a scenario file. Its PCI function is enumerated: memory space and mastering are on,
// and messages where it has them. No options: as the file has it. Null where there is no such
// board: `why` then has a line that says what is wrong, cut to `why_bytes`.
struct hvp_board* hvp_board_open(const char* scenario, const struct hvp_board_options* options,
                                 char* why, size_t why_bytes);
// Null is no error. Nothing that came from the board may be used any more.
void hvp_board_close(struct hvp_board* board);

// What hvp_open() is given; valid until hvp_board_close(). A register access takes the time that it
// has on the scenario's bus; waiting lets simulated time go on until the interrupt or the time-out.
const struct hvp_bus* hvp_board_bus(struct hvp_board* board);

// From now on the board reaches `memory` at `bus_address` and behind. False where the scenario's
// board is no bus master, the range is empty, or overlaps another one or the window of messages
// (0xfee00000).
bool hvp_board_map(struct hvp_board* board, uint64_t bus_address, void* memory, size_t bytes);
// All ranges that lie in [bus_address, bus_address + bytes); false, and nothing has changed, where
// one lies there in part.
bool hvp_board_unmap(struct hvp_board* board, uint64_t bus_address, uint64_t bytes);

// An access to the BAR of 1, 2, 4 or 8 bytes, or of a block of words, as docs/registers.md defines
// them.
void hvp_board_read(struct hvp_board* board, uint64_t offset, void* data, size_t bytes);
void hvp_board_write(struct hvp_board* board, uint64_t offset, const void* data, size_t bytes);
// The configuration space; 1, 2 or 4 bytes at a multiple of their number. Takes no time.
uint32_t hvp_board_config_read(struct hvp_board* board, uint32_t offset, size_t bytes);
void hvp_board_config_write(struct hvp_board* board, uint32_t offset, uint32_t value, size_t bytes);

// Simulated time since the board was opened.
uint64_t hvp_board_now_ps(const struct hvp_board* board);
// When something is due next; false where all waits for the host.
bool hvp_board_next_event_ps(const struct hvp_board* board, uint64_t* when_ps);
// Simulates up to this time; returns earlier, with false, when an interrupt was raised or lowered,
// and at once for a time beyond 10^18, eleven days.
bool hvp_board_run_until_ps(struct hvp_board* board, uint64_t time_ps);
// Whether INTA# is up, or a message has come since the last call.
bool hvp_board_interrupt(struct hvp_board* board);

// A job is what the driver does from the first word of b, or the first change of a row, until the
// next job begins (vp/function/job_frames.h). Of the last one that is over:
struct hvp_board_job {
  uint64_t number;    // 0 for the first
  uint64_t begin_ps;  // since the board was opened
  uint64_t end_ps;
  uint64_t host_ps;  // what it waited for: the host, its bus, the board
  uint64_t bus_ps;
  uint64_t fpga_ps;
};
// Begins a new job in any case. False where there has been none.
bool hvp_board_last_job(struct hvp_board* board, struct hvp_board_job* job);
// NOLINTEND(readability-identifier-naming)

#ifdef __cplusplus
}
#endif

#endif
