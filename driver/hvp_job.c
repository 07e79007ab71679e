// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#include "driver/hvp_device.h"

enum { RESULT_WORDS = 10 };
// The first of the numerical flags (RESULT_FLAGS in docs/registers.md).
#define SATURATION 1U
static_assert(offsetof(hvp_t, RESULT_CYCLES_HIGH) - offsetof(hvp_t, RESULT_JOB) ==
                  4 * (RESULT_WORDS - 1),
              "one burst reads RESULT_JOB to RESULT_CYCLES_HIGH");

static hvp_status check_vector(const struct hvp_device* device, const int32_t* vector, size_t n) {
  if (device == NULL || vector == NULL) return HVP_ERROR_ARGUMENT;
  if (device->state != STATE_LOADED) return HVP_ERROR_STATE;
  return n == (size_t)3 * device->nodes ? HVP_OK : HVP_ERROR_ARGUMENT;
}

hvp_status hvp_write_rhs(struct hvp_device* device, const int32_t* b, size_t n) {
  const hvp_status status = check_vector(device, b, n);
  if (status != HVP_OK) return status;
  if (!hvp_elements_fit(b, n, rhs_bits(device))) return HVP_ERROR_RANGE;
  if (device->uses_dma) {
    hvp_fill_segments(device, b);
  } else {
    hvp_write_elements(device, HVP_OFFSET(B), b, n, rhs_bits(device));
  }
  return HVP_OK;
}

hvp_status hvp_write_initial_guess(struct hvp_device* device, const int32_t* u, size_t n) {
  const hvp_status status = check_vector(device, u, n);
  if (status != HVP_OK) return status;
  if (!hvp_elements_fit(u, n, vector_bits(device))) return HVP_ERROR_RANGE;
  hvp_write_elements(device, HVP_OFFSET(U), u, n, vector_bits(device));
  return hvp_bus_errors(device);
}

hvp_status hvp_start(struct hvp_device* device) {
  if (device == NULL) return HVP_ERROR_ARGUMENT;
  if (device->state != STATE_LOADED) return HVP_ERROR_STATE;
  ++device->job;
  if (device->uses_dma) {
    hvp_run_list(device);
  } else {
    hvp_clear_done(device);
    hvp_write_register(device, HVP_OFFSET(CONTROL), HVP__CONTROL__START_bm);
  }
  device->state = STATE_RUNNING;
  hvp_enable_interrupts(device);
  return hvp_bus_errors(device);
}

hvp_status hvp_wait(struct hvp_device* device, uint64_t timeout_ns) {
  if (device == NULL) return HVP_ERROR_ARGUMENT;
  if (device->state != STATE_RUNNING) return HVP_ERROR_STATE;
  const hvp_status status =
      device->uses_dma ? hvp_await_record(device, timeout_ns) : hvp_await_end(device, timeout_ns);
  // After these, and after an error that came in between, the job runs on.
  if (status == HVP_ERROR_TIMEOUT || status == HVP_ERROR_INTERRUPTED || status == HVP_ERROR_BUS) {
    return status;
  }
  if ((device->last_status & HVP__STATUS__BUSY_bm) == 0U) device->state = STATE_LOADED;
  if (status == HVP_OK && device->reject_saturated && (hvp_last_flags(device) & SATURATION) != 0U) {
    return HVP_ERROR_SATURATED;
  }
  return status;
}

hvp_status hvp_read_solution(struct hvp_device* device, int32_t* u, size_t n) {
  const hvp_status status = check_vector(device, u, n);
  if (status != HVP_OK) return status;
  if (device->uses_dma) {
    hvp_empty_segments(device, u);
    return HVP_OK;
  }
  hvp_read_elements(device, HVP_OFFSET(U), u, n, vector_bits(device));
  return hvp_bus_errors(device);
}

hvp_status hvp_read_result(struct hvp_device* device, struct hvp_result* result) {
  if (device == NULL || result == NULL) return HVP_ERROR_ARGUMENT;
  if (device->state != STATE_LOADED || device->job == 0U) return HVP_ERROR_STATE;
  const uint32_t* words = device->scratch;
  device->bus.read_block(device->bus.context, HVP_OFFSET(RESULT_JOB), device->scratch,
                         RESULT_WORDS);
  if (words[0] != device->job) return HVP_ERROR_STALE_RESULT;
  *result = (struct hvp_result){.job = words[0],
                                .iterations = words[1],
                                .reached = FIELD(words[2], HVP__RESULT_END__REACHED) != 0U,
                                .replacements = words[3],
                                .saturations = words[4],
                                .wraps = words[5],
                                .breakdowns = words[6],
                                .flags = words[7],
                                .cycles = (uint64_t)words[9] << 32U | words[8]};
  return HVP_OK;
}

hvp_status hvp_solve(struct hvp_device* device, const int32_t* b, int32_t* u, size_t n,
                     uint64_t timeout_ns) {
  if (u == NULL) return HVP_ERROR_ARGUMENT;
  hvp_status status = hvp_write_rhs(device, b, n);
  if (status == HVP_OK) status = hvp_start(device);
  if (status == HVP_OK) status = hvp_wait(device, timeout_ns);
  if (status == HVP_OK) status = hvp_read_solution(device, u, n);
  return status;
}

uint32_t hvp_last_flags(const struct hvp_device* device) {
  return device == NULL ? 0U : FIELD(device->last_status, HVP__STATUS__FLAGS);
}

struct hvp_statistics hvp_statistics_of(const struct hvp_device* device) {
  const struct hvp_statistics none = {0U, 0U};
  return device == NULL ? none : device->statistics;
}

uint32_t hvp_error_detail(const struct hvp_device* device) {
  return device == NULL ? 0U : device->error_detail;
}

int hvp_caller_error(const struct hvp_device* device) {
  return device == NULL ? 0 : device->caller_error;
}
