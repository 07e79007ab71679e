#ifndef HVP_SERVO_FRAMES_H
#define HVP_SERVO_FRAMES_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "driver/hvp_driver.h"

#ifdef __cplusplus
extern "C" {
#endif

// The file that hvp-servo reads, a matrix and what each frame does with it, and the one that it
// writes. Both are 32-bit words, little-endian; a number of 64 bits is two of them, the lower half
// first.
//
//   frames: magic, version, nodes, blocks, frames, period in ns (2 words), 0
//           settings: method, start, iterations, stop_residual (2), replace_every, static_shift,
//             flags, headroom_bits, scaling_threshold, scaling_step, matrix_bits, vector_bits,
//             rhs_bits, scalar_bits, coefficient_bits, alpha_fraction, beta_fraction,
//             division_rounding, shift_rounding (struct hvp_solver_config; `flags` are
//             HVP_IOC_C_... of hvp_ioctl.h)
//           matrix: row_begin [nodes + 1], column [blocks], value [9·blocks]
//           each frame: the number of updates; each update: its kind, a node, and the diagonal of
//             a constraint, or the number of blocks of a row and nine values each; then b [3·nodes]
//   output: magic, version, nodes, frames
//           each frame: the record of struct servo_record, then U [3·nodes]
enum {
  SERVO_FRAMES_MAGIC = 0x46505648,  // HVPF
  SERVO_OUTPUT_MAGIC = 0x55505648,  // HVPU
  SERVO_VERSION = 1
};

enum { SERVO_CONSTRAIN = 0, SERVO_RESTORE = 1 };

struct servo_update {
  uint32_t kind;
  uint32_t node;
  int32_t diagonal;       // of a constraint
  uint32_t blocks;        // of a row
  const int32_t* values;  // [9·blocks]
};

// A whole file in memory, looked through from its beginning to its end when it was opened.
struct servo_frames {
  uint32_t* words;
  size_t count;
  size_t at;  // the next word to be taken
  uint64_t period_ns;
  uint32_t frames;
  struct hvp_solver_config config;
  struct hvp_matrix matrix;
};

// What became of a frame; times of CLOCK_MONOTONIC, ns.
struct servo_record {
  uint64_t due;      // when it was to begin
  uint64_t woken;    // when it began
  uint64_t started;  // the job
  uint64_t ended;    // the wait for it
  uint64_t read;     // U
  uint32_t status;   // hvp_status
  uint32_t flags;    // hvp_client_last_flags()
};

// False where it is no such file, after a line to stderr that says what is wrong. The frames may
// hold what a board refuses: the driver says so.
bool servo_open_frames(struct servo_frames* frames, const char* path);
void servo_close_frames(struct servo_frames* frames);

// The next frame, part by part in the file's order. The caller takes as many as there are.
uint32_t servo_take_updates(struct servo_frames* frames);
struct servo_update servo_take_update(struct servo_frames* frames);
const int32_t* servo_take_rhs(struct servo_frames* frames);

// False where it cannot be written.
bool servo_write_head(FILE* file, const struct servo_frames* frames);
bool servo_write_frame(FILE* file, const struct servo_record* record, const int32_t* u, size_t n);

#ifdef __cplusplus
}
#endif

#endif
