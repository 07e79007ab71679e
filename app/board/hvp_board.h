#ifndef HVP_BOARD_H
#define HVP_BOARD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "driver/hvp_driver.h"

// The board of a scenario inside your own program (docs/first-driver.md), so that a driver can run
// in simulated time before a real board exists. The library starts no thread, and its functions
// must be called from one thread only. SystemC elaborates once in a process, so a process can open
// one board, once.
#ifdef __cplusplus
extern "C" {
#endif

// C's names.
// NOLINTBEGIN(readability-identifier-naming)
struct hvp_board;

struct hvp_board_options {
  const char* const* overrides;  // "key=value", as `hvp run --set` has them
  size_t override_count;
  // The folder for registers.log, registers.vcd and dma.log, as `hvp run --trace-registers` writes
  // them. The files get their names when the board is closed. Null: no trace.
  const char* trace;
  // Watches the driver (docs/driver-rules.md): what it does wrong is said on the standard error
  // output when it happens, and returned by hvp_board_findings().
  bool check;
  // The file into which everything between the program and the board is recorded, for `hvp replay`
  // (docs/replay.md). It gets its name when the board is closed, and is <file>.part until then.
  // Null: no record.
  const char* record;
};

// Opens the board of a scenario file. Its PCI function is enumerated: memory space and bus
// mastering are enabled, and messages if it has them. Null `options` change nothing. Returns null
// on an error; `why` then has one line that describes it, cut to `why_bytes`.
struct hvp_board* hvp_board_open(const char* scenario, const struct hvp_board_options* options,
                                 char* why, size_t why_bytes);
// Null is allowed. Nothing obtained from the board may be used afterwards.
void hvp_board_close(struct hvp_board* board);

// The bus for hvp_open(), valid until hvp_board_close(). A register access takes its time on the
// scenario's bus; waiting advances simulated time until the interrupt or the time-out.
const struct hvp_bus* hvp_board_bus(struct hvp_board* board);

// Gives the board access to `memory` from `bus_address` on. Returns false if the scenario's board
// is no bus master, or if the range is empty or overlaps another one or the window of messages
// (0xfee00000).
bool hvp_board_map(struct hvp_board* board, uint64_t bus_address, void* memory, size_t bytes);
// Removes all ranges inside [bus_address, bus_address + bytes). Returns false without changing
// anything if a range lies there in part.
bool hvp_board_unmap(struct hvp_board* board, uint64_t bus_address, uint64_t bytes);

// What the program has stored in mapped memory is visible to the board from now on, as behind
// Linux' dma_wmb(). It matters with guest.memory_order = "weak" alone: the board may else see it
// late, a line of 64 bytes at a time (docs/driver-rules.md). For the `sync` of struct hvp_dma.
void hvp_board_barrier(struct hvp_board* board);

// Accesses 1, 2, 4 or 8 bytes of the BAR, or a block of words, as docs/registers.md defines.
void hvp_board_read(struct hvp_board* board, uint64_t offset, void* data, size_t bytes);
void hvp_board_write(struct hvp_board* board, uint64_t offset, const void* data, size_t bytes);
// Accesses 1, 2 or 4 bytes of the configuration space at a multiple of their number. Takes no time
// but that of the posted writes before it, which it does not overtake.
uint32_t hvp_board_config_read(struct hvp_board* board, uint32_t offset, size_t bytes);
void hvp_board_config_write(struct hvp_board* board, uint32_t offset, uint32_t value, size_t bytes);

// Accesses a word of BAR 2, with the table of MSI-X where the scenario asks for it (function.msi_x,
// docs/pci-function.md); else a read gives all ones. Time passes as with the configuration space.
uint32_t hvp_board_table_read(struct hvp_board* board, uint32_t offset);
void hvp_board_table_write(struct hvp_board* board, uint32_t offset, uint32_t value);

// The simulated time since the board was opened.
uint64_t hvp_board_now_ps(const struct hvp_board* board);
// The time of the next event. False if everything waits for the host.
bool hvp_board_next_event_ps(const struct hvp_board* board, uint64_t* when_ps);
// Simulates up to a time. Returns earlier, with false, when an interrupt is raised or lowered and
// at a point of hvp_board_stop_at(), and at once for a time beyond 10^18 ps, eleven days.
bool hvp_board_run_until_ps(struct hvp_board* board, uint64_t time_ps);
// True if INTA# is up, or a message has arrived since the last call.
bool hvp_board_interrupt(struct hvp_board* board);

// Makes a fault happen, in the words of a scenario's [[fault]] (docs/faults.md) with commas
// between: "kind=lost-interrupt", "kind=master-abort,access=status,count=2",
// "kind=stuck-busy,frame=7". A frame is a job (hvp_board_job.number). Without `frame` and `rate`
// the fault strikes from now on where it can next: the next interrupt, start or such access of a
// job. Returns false on an error without changing anything; `why` then has one line that describes
// it. A fault that has not happened when the board is closed is named on the standard error output.
bool hvp_board_inject(struct hvp_board* board, const char* fault, char* why, size_t why_bytes);

// A point of simulated time that was asked for has come.
struct hvp_board_stop {
  const char* point;  // as it was asked for
  const char* what;   // one line: the word, the time and the job
  uint64_t time_ps;   // now
  int64_t job;        // the newest that the program has begun, by this access too; -1: none
  uint64_t offset;    // of an access
  uint32_t value;     // an access' word, or the number in `point`
};
// Called at the point's own time. It may inject faults, and ask for further points and for the
// time; no time can pass in it: accesses read ones and have no effect, and a wait ends at once.
// The texts are valid until it returns.
typedef void (*hvp_board_stopped)(void* context, const struct hvp_board_stop* stop);

// Calls `stopped` at a point:
//   "write to CONTROL"  the program makes the access, which has had no effect yet
//   "read of STATUS"    its answer has arrived; names are those of docs/registers.md
//   "interrupt 3"       the third since the board was opened, a message or a line that goes up
//   "message 3"         the third message
//   "job 7"             before the first access of job 7 (hvp_board_job.number)
// An access is such a point each time. A null `stopped` takes the points of these words away again.
// Returns false on an error without changing anything; `why` then has one line that describes it.
bool hvp_board_stop_at(struct hvp_board* board, const char* point, hvp_board_stopped stopped,
                       void* context, char* why, size_t why_bytes);

// The figures of a finished job. A job consists of what the driver does from the first word of b,
// or the first change of a row, until the next job begins (vp/function/job_frames.h).
struct hvp_board_job {
  uint64_t number;    // 0 for the first
  uint64_t begin_ps;  // since the board was opened
  uint64_t end_ps;
  uint64_t host_ps;  // time spent waiting for the host, the bus and the board
  uint64_t bus_ps;
  uint64_t fpga_ps;
  // As the board's words tell it: HVP_OK, the board's error, or HVP_ERROR_TIMEOUT for a job that
  // the host went on without.
  hvp_status status;
};
// Returns the last finished job, and begins a new job in any case. False if there has been none. A
// job whose end the host has not seen is finished, as a failed one, when the board is reset. Waits
// until the writes that the host has posted have arrived.
bool hvp_board_last_job(struct hvp_board* board, struct hvp_board_job* job);

// A rule that the driver has broken, and the first time.
struct hvp_board_finding {
  const char* rule;  // its name in docs/driver-rules.md
  const char* what;  // one line
  uint64_t count;    // how often
  uint64_t first_ps;
  int64_t job;      // the number of the job, -1: before any
  uint64_t access;  // the number of accesses to the BAR until then
  // The address in the program, and its functions there as "inner < outer": of the access that
  // `what` names, or of the start of the job whose transfer it does. Zero and "" where the program
  // has no symbols.
  uint64_t program_counter;
  const char* function;
};
// Copies the findings, by the time of the first, into the `room` elements of `findings`, and
// returns how many there are. Zero without hvp_board_options.check. The texts are valid until the
// next call.
size_t hvp_board_findings(struct hvp_board* board, struct hvp_board_finding* findings, size_t room);
// NOLINTEND(readability-identifier-naming)

#ifdef __cplusplus
}
#endif

#endif
