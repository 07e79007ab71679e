# SPDX-License-Identifier: Apache-2.0
"""The C sources of the checkout as the extension module hvp_board._driver.

Only what Python calls is declared here; the compiler compares it with the C headers, which have the
rest and say what each call does.
"""

import os
from pathlib import Path

from cffi import FFI

HERE = Path(__file__).resolve().parent
TOP = HERE.parent.parent

DECLARATIONS = """
typedef enum { HVP_OK, HVP_ERROR_INTERRUPTED, HVP_STATUS_COUNT, ... } hvp_status;
enum { HVP_INTERRUPT, HVP_INTERRUPT_TIMED_OUT, HVP_INTERRUPT_BUS_FAILED, ... };
const char* hvp_status_text(hvp_status status);
const char* hvp_status_name(hvp_status status);

typedef int... hvp_method;
typedef int... hvp_start_from;
typedef int... hvp_round;

struct hvp_bus {
  void* context;
  uint32_t (*read32)(void*, uint32_t);
  void (*write32)(void*, uint32_t, uint32_t);
  void (*read_block)(void*, uint32_t, uint32_t*, size_t);
  void (*write_block)(void*, uint32_t, const uint32_t*, size_t);
  int (*wait_interrupt)(void*, uint64_t);
  uint64_t (*now_ns)(void*);
  void (*pause)(void*);
  _Bool interrupts_after_writes;
  ...;
};
struct hvp_capability {
  uint32_t max_nodes, max_row_blocks, max_blocks, max_matrix_bits, max_vector_bits, max_rhs_bits,
    max_coefficient_bits, clock_khz, methods, start_modes, max_scalar_bits;
};
struct hvp_statistics { uint32_t lost_interrupts, lost_acknowledgements; };
struct hvp_solver_config {
  hvp_method method;
  hvp_start_from start;
  uint32_t iterations;
  uint64_t stop_residual;
  uint32_t replace_every, static_shift;
  _Bool dynamic_scaling, scaling_up_only;
  uint32_t headroom_bits, scaling_threshold, scaling_step, matrix_bits, vector_bits, rhs_bits,
    scalar_bits, coefficient_bits;
  _Bool fixed_coefficients;
  uint32_t alpha_fraction, beta_fraction;
  hvp_round division_rounding, shift_rounding;
  _Bool one_a_word, wrap_overflow, reject_saturated;
};
struct hvp_matrix {
  uint32_t nodes, blocks;
  const int32_t* row_begin;
  const int32_t* column;
  const int32_t* value;
};
struct hvp_result {
  uint32_t job, iterations;
  _Bool reached;
  uint32_t replacements, saturations, wraps, breakdowns, flags;
  uint64_t cycles;
};

struct hvp_client;
struct hvp_client_info { _Bool dma, interrupts, messages; uint32_t longest_wait_ms; };
hvp_status hvp_client_open(struct hvp_client**, const char*);
const char* hvp_client_schemes(void);
hvp_status hvp_client_open_bus(struct hvp_client**, const struct hvp_bus*);
hvp_status hvp_client_close(struct hvp_client*);
const struct hvp_client_info* hvp_client_info_of(const struct hvp_client*);
const struct hvp_capability* hvp_client_capability(const struct hvp_client*);
int hvp_client_descriptor(const struct hvp_client*);
hvp_status hvp_client_reset(struct hvp_client*);
hvp_status hvp_client_configure(struct hvp_client*, const struct hvp_solver_config*);
hvp_status hvp_client_load_matrix(struct hvp_client*, const struct hvp_matrix*);
hvp_status hvp_client_constrain_node(struct hvp_client*, uint32_t, int32_t);
hvp_status hvp_client_restore_node(struct hvp_client*, uint32_t, const int32_t*, uint32_t);
hvp_status hvp_client_update_values(struct hvp_client*, const int32_t*, size_t, uint64_t);
hvp_status hvp_client_write_rhs(struct hvp_client*, const int32_t*, size_t);
hvp_status hvp_client_write_initial_guess(struct hvp_client*, const int32_t*, size_t);
hvp_status hvp_client_start(struct hvp_client*);
hvp_status hvp_client_wait(struct hvp_client*, uint64_t);
hvp_status hvp_client_read_solution(struct hvp_client*, int32_t*, size_t);
hvp_status hvp_client_read_result(struct hvp_client*, struct hvp_result*);
hvp_status hvp_client_statistics(struct hvp_client*, struct hvp_statistics*);
uint32_t hvp_client_error_detail(const struct hvp_client*);
uint32_t hvp_client_last_flags(const struct hvp_client*);

extern "Python" {
  uint32_t bus_read32(void*, uint32_t);
  void bus_write32(void*, uint32_t, uint32_t);
  void bus_read_block(void*, uint32_t, uint32_t*, size_t);
  void bus_write_block(void*, uint32_t, const uint32_t*, size_t);
  int bus_wait_interrupt(void*, uint64_t);
  uint64_t bus_now_ns(void*);
}
"""


def sources() -> list[str]:
    found = sorted([*TOP.glob("driver/*.c"), *TOP.glob("driver/user/*.c")])
    return [os.path.relpath(path, HERE) for path in found]


builder = FFI()
builder.cdef(DECLARATIONS)
builder.set_source(
    "hvp_board._driver",
    '#include "driver/user/hvp_client.h"',
    sources=sources(),
    include_dirs=[str(TOP)],
    define_macros=[("_GNU_SOURCE", None)],
    extra_compile_args=["-std=c11"],
)
