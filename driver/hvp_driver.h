// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#ifndef HVP_DRIVER_H
#define HVP_DRIVER_H

#include "driver/hvp_bus.h"
#include "driver/hvp_status.h"

// The driver of the solver board: loads a matrix K, changes single rows of it or all its entries,
// sends b, starts a solve of K·U = b, waits for it and fetches U. docs/driver.md shows a frame;
// docs/registers.md is the board. It reaches the board through the call-backs of struct hvp_bus
// only and allocates nothing. One thread owns a device handle, and beside it an interrupt's handler
// may call hvp_irq(); two boards are two handles.
#ifdef __cplusplus
extern "C" {
#endif

// The smallest scratch area: one burst of settings.
#define HVP_MIN_SCRATCH_WORDS 16U

// The time-out of the board's check of a matrix: thousands of times the time for 8192 nodes.
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

// The errors since hvp_open() that were put right at the cost of time.
struct hvp_statistics {
  uint32_t lost_interrupts;        // interrupts that did not come although the board had ended
  uint32_t lost_acknowledgements;  // acknowledgements that did not arrive and were repeated
};

// A board. The caller provides the memory; the members are the driver's own.
struct hvp_device {
  struct hvp_bus bus;
  uint32_t* scratch;
  size_t scratch_words;
  struct hvp_capability capability;
  int state;
  uint32_t format;
  uint32_t method;
  uint32_t nodes;
  uint32_t blocks;  // of the loaded matrix
  uint32_t job;
  uint32_t last_status;
  uint32_t error_detail;
  int caller_error;
  bool interrupts_on;  // the value of INTERRUPT_ENABLE; under the bus' lock, if it has one
  struct hvp_statistics statistics;
  bool timed_out;  // the last wait timed out
  bool reject_saturated;
  uint32_t minor_version;
  bool one_a_word;    // elements of at most 16 bits are not packed
  bool done_pending;  // INTERRUPT_STATUS.done of a list is still set, and the next list clears it
  bool uses_dma;
  struct hvp_dma dma;
  uint32_t bytes_to_board;  // of a list for the loaded matrix
  uint32_t bytes_to_host;
  uint32_t bytes_of_values;  // likewise; 0: they go by blocks
};

// The choices of struct hvp_solver_config; docs/fixed-point.md defines them.
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
  HVP_START_FROM_EXTRAPOLATED,  // 2·U − (the U before), if the board has both
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
                           // from 2^-511 to 1; 0: the count alone
  uint32_t replace_every;      // iterations after which r is formed anew, up to 65535; 0: never
  uint32_t static_shift;       // m of the static scale 2^m (thesis §4.2), 0 to 63
  bool dynamic_scaling;        // thesis §4.2
  bool scaling_up_only;        // does not scale down when a vector grows
  uint32_t headroom_bits;      // kept free by dynamic scaling, 0 to 15
  uint32_t scaling_threshold;  // free bits before it scales up, up to 31; 0: 1
  uint32_t scaling_step;       // a re-scaling is a multiple of this number of bits, up to 31; 0: 1
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
  bool wrap_overflow;     // a word that overflows keeps its low bits instead of its limit
  bool reject_saturated;  // a job in which a word reached its limit ends in HVP_ERROR_SATURATED
};

// A symmetric matrix of 3 × 3 blocks: both triangles are stored, columns ascend within a block row,
// and every diagonal block is present. It is the caller's own and is read during hvp_load_matrix()
// only.
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
  size_t sent;     // elements of that array that were sent
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
  uint64_t cycles;  // clocks of the board from start to done
};

// Checks that a board with a known register map is present, reads its capabilities and resets it.
// Bursts are packed in `scratch` and are never longer than it, so that 3·nodes words make each
// transfer of b or U a single burst. It stays in use until hvp_close().
hvp_status hvp_open(struct hvp_device* device, const struct hvp_bus* bus, uint32_t* scratch,
                    size_t scratch_words);

// Aborts the current job and brings the board into the state after hvp_open(): settings and matrix
// are gone. It ends a time-out.
hvp_status hvp_reset(struct hvp_device* device);

// Disables the board's interrupt. The handle is closed afterwards, whatever is returned.
hvp_status hvp_close(struct hvp_device* device);

const struct hvp_capability* hvp_capability_of(const struct hvp_device* device);

// Writes the settings in one burst. It may be repeated between jobs; changing the method or a word
// length drops the loaded matrix. Returns HVP_ERROR_ARGUMENT for a setting that no board has, and
// HVP_ERROR_CAPABILITY for one that this board lacks. A board may have narrower ranges, which it
// reports at the next start or load (HVP_ERROR_BAD_SETTING).
hvp_status hvp_configure(struct hvp_device* device, const struct hvp_solver_config* config);

// Sends the whole matrix and has the board check it.
// HVP_ERROR_INTERRUPTED while it does so: call again, with the same matrix; nothing is sent twice.
hvp_status hvp_load_matrix(struct hvp_device* device, const struct hvp_matrix* matrix);

// The same in pieces, for a process with other work in between: begin; then continue, one burst at
// a time, until *complete; then end, which has the board check the matrix. The matrix has to stay
// in place. Only these calls, hvp_reset() and hvp_close() are allowed meanwhile. An end that
// returned HVP_ERROR_INTERRUPTED is called again.
hvp_status hvp_begin_load(struct hvp_device* device, struct hvp_load* load,
                          const struct hvp_matrix* matrix);
hvp_status hvp_continue_load(struct hvp_device* device, struct hvp_load* load, bool* complete);
hvp_status hvp_end_load(struct hvp_device* device, const struct hvp_load* load);

// Replaces the entries of the loaded matrix and keeps its pattern, its constrained nodes and U:
// `values` has nine entries a block, in the order in which hvp_load_matrix() had them, n =
// 9·blocks. Those in the rows and columns of constrained nodes are not used; hvp_restore_node()
// brings them. With memory for them (`values` of struct hvp_dma) the board's DMA engine fetches
// them, else they are blocks of writes. The board solves with neither matrix until this has ended:
// after an error the matrix has to be loaded again, after a reset if the error is not the board's.
// HVP_ERROR_TIMEOUT: the board is busy with them timeout_ns after the last was sent, or after it
// was told to fetch them. HVP_ERROR_INTERRUPTED while it takes them: call again; nothing is sent
// twice. HVP_ERROR_CAPABILITY: the board's register map is older than version 2.3.
hvp_status hvp_update_values(struct hvp_device* device, const int32_t* values, size_t n,
                             uint64_t timeout_ns);

// Zeroes the node's block row and column but for the diagonal entries, which become `diagonal` > 0
// (thesis §3.7).
hvp_status hvp_constrain_node(struct hvp_device* device, uint32_t node, int32_t diagonal);

// Restores the node's block row, and by symmetry its column. `values` has nine entries for each of
// the row's `blocks` blocks, in the order in which hvp_load_matrix() had them. Blocks towards a
// node that is still constrained have to be zero, because the board does not check them.
hvp_status hvp_restore_node(struct hvp_device* device, uint32_t node, const int32_t* values,
                            uint32_t blocks);

// The number of descriptors that a list may have; 0 where the board has no engine.
uint32_t hvp_dma_descriptors(const struct hvp_device* device);

// Lets the board's DMA engine move b and U from now on: hvp_write_rhs() packs b into memory,
// hvp_start() rings the doorbell, hvp_wait() reads the completion record, hvp_read_solution()
// unpacks U, and hvp_update_values() packs entries where there is memory for them; all other
// transfers are unchanged. Keeps a copy of *dma, not of the segments. Null
// returns to blocks. It is allowed between jobs only. HVP_ERROR_CAPABILITY: no engine, or not for
// so many segments. HVP_ERROR_ARGUMENT: an address, or segments too small for the loaded matrix; a
// matrix that is loaded later and does not fit is refused then.
hvp_status hvp_use_dma(struct hvp_device* device, const struct hvp_dma* dma);

// The bytes that all entries of the loaded matrix take in `values` of struct hvp_dma; 0 where the
// board's engine does not fetch them, or no matrix is loaded.
size_t hvp_dma_values_bytes(const struct hvp_device* device);

// The right-hand side; n = 3·nodes.
hvp_status hvp_write_rhs(struct hvp_device* device, const int32_t* b, size_t n);

// The initial guess of the next warm start, instead of the last solution; n = 3·nodes.
hvp_status hvp_write_initial_guess(struct hvp_device* device, const int32_t* u, size_t n);

// Starts a job and returns at once. Nothing but hvp_wait(), hvp_reset() and hvp_close() is allowed
// until it has ended. HVP_ERROR_BUS or HVP_ERROR_DATA: the bus reports that b or the start did not
// arrive; the board may be busy, but not with this job.
hvp_status hvp_start(struct hvp_device* device);

// Waits until the job has ended, or timeout_ns have passed. The status register is read before a
// time-out is reported, so that a lost interrupt costs time only. HVP_ERROR_INTERRUPTED: the bus'
// wait_interrupt gave up for a reason of the caller's; the job goes on, and the call may be
// repeated.
hvp_status hvp_wait(struct hvp_device* device, uint64_t timeout_ns);

// Returns HVP_ERROR_BUS or HVP_ERROR_DATA if the bus reports a failure; the board still has U,
// which may be read again.
hvp_status hvp_read_solution(struct hvp_device* device, int32_t* u, size_t n);

// Reads the result of the last job that has ended, in one burst.
hvp_status hvp_read_result(struct hvp_device* device, struct hvp_result* result);

// Calls hvp_write_rhs(), hvp_start(), hvp_wait() and hvp_read_solution().
hvp_status hvp_solve(struct hvp_device* device, const int32_t* b, int32_t* u, size_t n,
                     uint64_t timeout_ns);

// The low 16 numerical flags of the job that hvp_wait() saw end. No access to the board.
uint32_t hvp_last_flags(const struct hvp_device* device);

// Makes no access to the board.
struct hvp_statistics hvp_statistics_of(const struct hvp_device* device);

// The detail of the last error that the board reported: see ERROR in docs/registers.md. Makes no
// access to the board.
uint32_t hvp_error_detail(const struct hvp_device* device);

// The negative number with which wait_interrupt ended the last wait; 0 if that was not interrupted.
// No access to the board.
int hvp_caller_error(const struct hvp_device* device);

// The results of hvp_irq().
enum {
  HVP_IRQ_NONE = 0,  // another board's, or not pending any more; nothing was changed
  HVP_IRQ_MINE = 1,  // this board's: wake the thread in wait_interrupt, which returns for it once
};

// The top half of an interrupt. It may be called from the interrupt's handler, beside the thread
// that owns the device, at any time except during hvp_open(), and it never sleeps. For a level
// (`line`), which may be shared and must be down when the handler returns, it reads
// INTERRUPT_STATUS and, if the interrupt is this board's, disables the board's interrupts, which
// the driver enables again when it next starts a job or waits. For a message it makes no access;
// nor does it before hvp_open(), after hvp_close(), while a line is masked, or if the board is
// gone. driver/hvp_irq.c says why no interrupt is lost.
int hvp_irq(struct hvp_device* device, bool line);

#ifdef __cplusplus
}
#endif

#endif
