#ifndef HVP_DRIVER_H
#define HVP_DRIVER_H

#include "driver/hvp_bus.h"
#include "driver/hvp_status.h"

// The driver of the solver board: loads a matrix K, changes single rows of it, sends b, starts a
// solve of K·U = b, waits for it and fetches U. docs/driver.md shows a frame; docs/registers.md is
// the board. It reaches the board through the call-backs of struct hvp_bus only and allocates
// nothing. One thread owns a device handle, and beside it an interrupt's handler may call
// hvp_irq(); two boards are two handles.
#ifdef __cplusplus
extern "C" {
#endif

// The smallest scratch area: one burst of settings.
#define HVP_MIN_SCRATCH_WORDS 16U

// How long the board may take to check a matrix: thousands of times what 8192 nodes take.
#define HVP_LOAD_TIMEOUT_NS ((uint64_t)1000000000)

struct hvp_capability {
  uint32_t max_nodes;
  uint32_t max_row_blocks;
  uint32_t max_blocks;
  uint32_t max_matrix_bits;
  uint32_t max_vector_bits;
  uint32_t max_rhs_bits;
  uint32_t max_coefficient_bits;
  uint32_t clock_khz;
  uint32_t methods;      // bit n: hvp_method n
  uint32_t start_modes;  // bit n: hvp_start_from n
  uint32_t max_scalar_bits;
};

// What went wrong and was put right at the cost of time, since hvp_open().
struct hvp_statistics {
  uint32_t lost_interrupts;        // did not come, though the board had ended
  uint32_t lost_acknowledgements;  // did not arrive, and were repeated
};

// A board. The caller provides the room; the members are the driver's own.
struct hvp_device {
  struct hvp_bus bus;
  uint32_t* scratch;
  size_t scratch_words;
  struct hvp_capability capability;
  int state;
  uint32_t format;
  uint32_t method;
  uint32_t nodes;
  uint32_t job;
  uint32_t last_status;
  uint32_t error_detail;
  int caller_error;
  bool interrupts_on;  // what INTERRUPT_ENABLE holds; under the bus' lock, where it has one
  struct hvp_statistics statistics;
  bool timed_out;  // the wait that has ended last
  bool reject_saturated;
  uint32_t minor_version;
  bool one_a_word;    // elements of at most 16 bits are not packed
  bool done_pending;  // INTERRUPT_STATUS.done of a list was left up: the next list clears it
  bool uses_dma;
  struct hvp_dma dma;
  uint32_t bytes_to_board;  // of a list for the loaded matrix
  uint32_t bytes_to_host;
};

// What the members of struct hvp_solver_config choose between; docs/fixed-point.md defines them.
typedef enum hvp_method {
  HVP_METHOD_CG = 0,            // thesis §4.2
  HVP_METHOD_JACOBI_PCG,        // thesis §4.3
  HVP_METHOD_BLOCK_JACOBI_PCG,  // with the inverse 3 × 3 blocks of the diagonal
  HVP_METHOD_CHRONOPOULOS_GEAR,
  HVP_METHOD_PIPELINED_CG,
  HVP_METHOD_COUNT
} hvp_method;

typedef enum hvp_start_from {
  HVP_START_FROM_ZERO = 0,
  HVP_START_FROM_LAST,          // the last U, or what hvp_write_initial_guess() wrote
  HVP_START_FROM_EXTRAPOLATED,  // 2·U − (the U before), where the board has both
  HVP_START_FROM_COUNT
} hvp_start_from;

typedef enum hvp_round {
  HVP_ROUND_NEAREST_UP = 0,  // ties away from zero
  HVP_ROUND_NEAREST_EVEN,
  HVP_ROUND_TRUNCATION,
  HVP_ROUND_COUNT
} hvp_round;

// Word lengths are bits of signed words, 2 to the board's capability. A member that says what zero
// means may be left out of an initialiser.
struct hvp_solver_config {
  hvp_method method;
  hvp_start_from start;
  uint32_t iterations;     // 1 to 65535
  uint64_t stop_residual;  // ends a job once ‖r‖ <= t·‖b‖: the bits of t, an IEEE 754 double
                           // from 0 to 1; 0: the count alone
  uint32_t replace_every;      // iterations after which r is formed anew, up to 65535; 0: never
  uint32_t static_shift;       // m of the static scale 2^m (thesis §4.2), 0 to 63
  bool dynamic_scaling;        // thesis §4.2
  bool scaling_up_only;        // makes no room where a vector grows
  uint32_t headroom_bits;      // kept free by dynamic scaling, 0 to 15
  uint32_t scaling_threshold;  // free bits before it scales up, up to 31; 0: 1
  uint32_t scaling_step;       // a re-scaling is a multiple of so many bits, up to 31; 0: 1
  uint32_t matrix_bits;        // entries of K
  uint32_t vector_bits;        // entries of U
  uint32_t rhs_bits;           // entries of b; 0: vector_bits, or 32 with a preconditioner
  uint32_t scalar_bits;        // inner products, 64 or 128; 0: 64
  uint32_t coefficient_bits;   // mantissas of α and β
  bool fixed_coefficients;     // α and β with a fixed point instead of a shift of their own:
  uint32_t alpha_fraction;     // bits of α behind it, 0 to 63
  uint32_t beta_fraction;      // bits of β behind it, 0 to 63
  hvp_round division_rounding;
  hvp_round shift_rounding;
  bool one_a_word;        // elements of at most 16 bits do not share a word on their way
  bool wrap_overflow;     // keep the low bits of what leaves its word, instead of its limit
  bool reject_saturated;  // a job in which a word reached its limit ends in HVP_ERROR_SATURATED
};

// Symmetric, of 3 × 3 blocks, both triangles stored, columns ascending within a block row, every
// diagonal block there. The caller's own; read during hvp_load_matrix() only.
struct hvp_matrix {
  uint32_t nodes;            // block rows
  uint32_t blocks;           // non-zero blocks
  const int32_t* row_begin;  // [nodes + 1], first block of each row; the last is `blocks`
  const int32_t* column;     // [blocks]
  const int32_t* value;      // [9·blocks], a block row by row
};

// A matrix on its way to the board; the members are the driver's own.
struct hvp_load {
  const struct hvp_matrix* matrix;
  uint32_t array;  // which of the matrix' arrays is next
  size_t sent;     // elements of it
};

struct hvp_result {
  uint32_t job;         // 1 for the first since hvp_open() or hvp_reset()
  uint32_t iterations;  // passes that changed U
  bool reached;         // stop_residual was met
  uint32_t replacements;
  uint32_t saturations;
  uint32_t wraps;
  uint32_t breakdowns;
  uint32_t flags;   // bit n: entry n of the numerical flags, see RESULT_FLAGS
  uint64_t cycles;  // of the board's clock, from start to done
};

// Makes sure that a board with a known register map is there, reads what it can do and resets it.
// `scratch` is where bursts are packed: a burst is never longer than it, so that 3·nodes words make
// each transfer of b or U a single burst. It stays in use until hvp_close().
hvp_status hvp_open(struct hvp_device* device, const struct hvp_bus* bus, uint32_t* scratch,
                    size_t scratch_words);

// Aborts whatever runs and brings the board into the state after hvp_open(): settings and matrix
// are gone. The way out of a time-out.
hvp_status hvp_reset(struct hvp_device* device);

// Takes the interrupt away from the board. The handle is dead afterwards, whatever is returned.
hvp_status hvp_close(struct hvp_device* device);

const struct hvp_capability* hvp_capability_of(const struct hvp_device* device);

// One burst. May be repeated between jobs; changing the method or a word length drops the loaded
// matrix. What no board has is HVP_ERROR_ARGUMENT, what this one lacks HVP_ERROR_CAPABILITY. A
// board may have narrower ranges: it says so at the next start or load (HVP_ERROR_BAD_SETTING).
hvp_status hvp_configure(struct hvp_device* device, const struct hvp_solver_config* config);

// Sends the whole matrix and has the board check it.
// HVP_ERROR_INTERRUPTED while it does so: call again, with the same matrix; nothing is sent twice.
hvp_status hvp_load_matrix(struct hvp_device* device, const struct hvp_matrix* matrix);

// The same in pieces, for a process that has other things to do in between: begin; then continue,
// a burst each, until *complete; then end, which has the board check the matrix. The matrix has to
// stay where it is. Nothing but these, hvp_reset() and hvp_close() may be called meanwhile. An end
// that returned HVP_ERROR_INTERRUPTED is called again.
hvp_status hvp_begin_load(struct hvp_device* device, struct hvp_load* load,
                          const struct hvp_matrix* matrix);
hvp_status hvp_continue_load(struct hvp_device* device, struct hvp_load* load, bool* complete);
hvp_status hvp_end_load(struct hvp_device* device, const struct hvp_load* load);

// Zeroes the node's block row and column but for the diagonal entries, which become `diagonal` > 0
// (thesis §3.7).
hvp_status hvp_constrain_node(struct hvp_device* device, uint32_t node, int32_t diagonal);

// Gives the node its block row back, and by symmetry its column. `values` has nine entries for each
// of the row's `blocks` blocks, in the order in which hvp_load_matrix() had them. Blocks towards a
// node that is still constrained have to be zero: the board writes what it is told.
hvp_status hvp_restore_node(struct hvp_device* device, uint32_t node, const int32_t* values,
                            uint32_t blocks);

// From now on b and U are moved by the board's DMA engine: hvp_write_rhs() packs b into memory,
// hvp_start() rings the doorbell, hvp_wait() reads the completion record, hvp_read_solution()
// unpacks U; all other transfers stay as they are. Keeps a copy of *dma, not of the segments. Null:
// back to blocks. Between jobs only. HVP_ERROR_CAPABILITY: no engine, or not for so many segments.
// HVP_ERROR_ARGUMENT: an address, or segments too small for the loaded matrix; a matrix that is
// loaded later and does not fit is refused then.
hvp_status hvp_use_dma(struct hvp_device* device, const struct hvp_dma* dma);

// The right-hand side; n = 3·nodes.
hvp_status hvp_write_rhs(struct hvp_device* device, const int32_t* b, size_t n);

// The initial guess of the next warm start, instead of the last solution; n = 3·nodes.
hvp_status hvp_write_initial_guess(struct hvp_device* device, const int32_t* u, size_t n);

// Starts a job and returns at once. Nothing but hvp_wait(), hvp_reset() and hvp_close() is
// allowed until it has ended. HVP_ERROR_BUS or HVP_ERROR_DATA where the bus says that b or the
// start did not arrive: the board may be at work, but not on this job.
hvp_status hvp_start(struct hvp_device* device);

// Until the job has ended, or timeout_ns have passed. The status register is read before a
// time-out is reported, so that a lost interrupt costs time only. HVP_ERROR_INTERRUPTED: the bus'
// wait_interrupt gave up for a reason of the caller's; the job goes on, wait again.
hvp_status hvp_wait(struct hvp_device* device, uint64_t timeout_ns);

// HVP_ERROR_BUS or HVP_ERROR_DATA where the bus says that it went wrong: the board still has U, and
// it may be read again.
hvp_status hvp_read_solution(struct hvp_device* device, int32_t* u, size_t n);

// Of the last job that has ended; one burst.
hvp_status hvp_read_result(struct hvp_device* device, struct hvp_result* result);

// write_rhs, start, wait, read_solution.
hvp_status hvp_solve(struct hvp_device* device, const int32_t* b, int32_t* u, size_t n,
                     uint64_t timeout_ns);

// The low 16 numerical flags of the job that hvp_wait() saw end. No access to the board.
uint32_t hvp_last_flags(const struct hvp_device* device);

// No access to the board.
struct hvp_statistics hvp_statistics_of(const struct hvp_device* device);

// The number that goes with the last error which the board reported: see ERROR in
// docs/registers.md. No access to the board.
uint32_t hvp_error_detail(const struct hvp_device* device);

// The negative number with which wait_interrupt ended the last wait; 0 if that was not interrupted.
// No access to the board.
int hvp_caller_error(const struct hvp_device* device);

// What an interrupt was.
enum {
  HVP_IRQ_NONE = 0,  // another board's, or no longer there: nothing was touched
  HVP_IRQ_MINE = 1,  // wake whoever is in wait_interrupt; wait_interrupt returns for it once
};

// The top half: from an interrupt's handler, beside the thread that owns the device, at any time
// but during hvp_open(). Sleeps nowhere. A level (`line`), which may be shared and must be down
// when the handler returns: reads INTERRUPT_STATUS, and where it was this board disables its
// interrupts, which the driver enables again when it next starts a job or waits. A message: touches
// nothing. Nothing either before hvp_open(), after hvp_close(), while a line is masked, or if the
// board is gone. driver/hvp_irq.c says why no interrupt is lost.
int hvp_irq(struct hvp_device* device, bool line);

#ifdef __cplusplus
}
#endif

#endif
