// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#include "driver/hvp_device.h"

enum { SETTINGS_WORDS = 11 };
static_assert(offsetof(hvp_t, START_MODE) - offsetof(hvp_t, METHOD) == 4 * (SETTINGS_WORDS - 1),
              "one burst writes METHOD to START_MODE");
enum { MINOR_VERSION_OF_PACKING = 1 };
static_assert(SETTINGS_WORDS <= HVP_MIN_SCRATCH_WORDS, "the burst fits every scratch area");

// The caller's enumerations are the registers' codes.
#define SAME(ours, theirs) static_assert((int)(ours) == (int)(theirs), #ours " is " #theirs)
SAME(HVP_METHOD_CG, HVP_SOLVER_METHOD_CG);
SAME(HVP_METHOD_JACOBI_PCG, HVP_SOLVER_METHOD_JACOBI_PCG);
SAME(HVP_METHOD_BLOCK_JACOBI_PCG, HVP_SOLVER_METHOD_BLOCK_JACOBI_PCG);
SAME(HVP_METHOD_CHRONOPOULOS_GEAR, HVP_SOLVER_METHOD_CHRONOPOULOS_GEAR);
SAME(HVP_METHOD_PIPELINED_CG, HVP_SOLVER_METHOD_PIPELINED_CG);
SAME(HVP_START_FROM_ZERO, HVP_START_MODE_ZERO);
SAME(HVP_START_FROM_LAST, HVP_START_MODE_WARM);
SAME(HVP_START_FROM_EXTRAPOLATED, HVP_START_MODE_EXTRAPOLATED);
SAME(HVP_ROUND_NEAREST_UP, HVP_ROUNDING_MODE_NEAREST_UP);
SAME(HVP_ROUND_NEAREST_EVEN, HVP_ROUNDING_MODE_NEAREST_EVEN);
SAME(HVP_ROUND_TRUNCATION, HVP_ROUNDING_MODE_TRUNCATION);

// Doubles from 0 to 1 are in the order of their bits; those below zero and NaN lie above.
#define BITS_OF_ONE ((uint64_t)0x3ff00000 << 32U)
#define BITS_OF_LEAST_RESIDUAL ((uint64_t)0x20000000 << 32U) /* 2^-511 */

static bool preconditioned(const struct hvp_solver_config* config) {
  return config->method == HVP_METHOD_JACOBI_PCG || config->method == HVP_METHOD_BLOCK_JACOBI_PCG;
}

// What zero stands for.
static void fill_in(struct hvp_solver_config* config) {
  if (config->rhs_bits == 0U) {
    config->rhs_bits = preconditioned(config) ? 32U : config->vector_bits;
  }
  if (config->scalar_bits == 0U) config->scalar_bits = 64U;
  if (config->scaling_threshold == 0U) config->scaling_threshold = 1U;
  if (config->scaling_step == 0U) config->scaling_step = 1U;
}

static bool possible(const struct hvp_solver_config* config) {
  const bool choices = (uint32_t)config->method < HVP_METHOD_COUNT &&
                       (uint32_t)config->start < HVP_START_FROM_COUNT &&
                       (uint32_t)config->division_rounding < HVP_ROUND_COUNT &&
                       (uint32_t)config->shift_rounding < HVP_ROUND_COUNT;
  const bool words = config->matrix_bits >= 2U && config->vector_bits >= 2U &&
                     config->rhs_bits >= 2U && config->coefficient_bits >= 2U &&
                     (config->scalar_bits == 64U || config->scalar_bits == 128U) &&
                     config->alpha_fraction <= 63U && config->beta_fraction <= 63U;
  const bool scaling = config->static_shift <= 63U && config->headroom_bits <= 15U &&
                       config->scaling_threshold <= 31U && config->scaling_step <= 31U;
  const bool counts =
      hvp_between(config->iterations, 1U, 0xffffU) && config->replace_every <= 0xffffU &&
      (config->stop_residual == 0U ||
       (config->stop_residual >= BITS_OF_LEAST_RESIDUAL && config->stop_residual <= BITS_OF_ONE));
  return choices && words && scaling && counts;
}

static bool within(const struct hvp_capability* capability,
                   const struct hvp_solver_config* config) {
  return config->matrix_bits <= capability->max_matrix_bits &&
         config->vector_bits <= capability->max_vector_bits &&
         config->rhs_bits <= capability->max_rhs_bits &&
         config->coefficient_bits <= capability->max_coefficient_bits &&
         config->scalar_bits <= capability->max_scalar_bits &&
         (capability->methods >> (uint32_t)config->method & 1U) != 0U &&
         (capability->start_modes >> (uint32_t)config->start & 1U) != 0U;
}

static uint32_t format_of(const struct hvp_solver_config* config) {
  return PLACE(config->matrix_bits, HVP__FORMAT__MATRIX_BITS) |
         PLACE(config->vector_bits, HVP__FORMAT__VECTOR_BITS) |
         PLACE(config->rhs_bits, HVP__FORMAT__RHS_BITS) |
         PLACE(config->coefficient_bits, HVP__FORMAT__COEFFICIENT_BITS);
}

static uint32_t scaling_of(const struct hvp_solver_config* config) {
  return PLACE(config->dynamic_scaling, HVP__SCALING__DYNAMIC) |
         PLACE(!config->scaling_up_only, HVP__SCALING__DOWN) |
         PLACE(config->headroom_bits, HVP__SCALING__HEADROOM_BITS) |
         PLACE(config->scaling_threshold, HVP__SCALING__THRESHOLD) |
         PLACE(config->scaling_step, HVP__SCALING__STEP);
}

static uint32_t coefficients_of(const struct hvp_solver_config* config) {
  const uint32_t format = config->fixed_coefficients ? HVP_COEFFICIENT_FORMAT_FIXED_POINT
                                                     : HVP_COEFFICIENT_FORMAT_OWN_SHIFT;
  return PLACE(format, HVP__COEFFICIENTS__FORMAT) |
         PLACE(config->alpha_fraction, HVP__COEFFICIENTS__ALPHA_FRACTION) |
         PLACE(config->beta_fraction, HVP__COEFFICIENTS__BETA_FRACTION);
}

static uint32_t arithmetic_of(const struct hvp_solver_config* config) {
  const uint32_t overflow =
      config->wrap_overflow ? HVP_OVERFLOW_MODE_WRAP : HVP_OVERFLOW_MODE_SATURATE;
  return PLACE(config->division_rounding, HVP__ARITHMETIC__DIVISION_ROUNDING) |
         PLACE(config->shift_rounding, HVP__ARITHMETIC__SHIFT_ROUNDING) |
         PLACE(overflow, HVP__ARITHMETIC__OVERFLOW) |
         PLACE(config->scalar_bits, HVP__ARITHMETIC__SCALAR_BITS);
}

hvp_status hvp_configure(struct hvp_device* device, const struct hvp_solver_config* config) {
  if (device == NULL || config == NULL) return HVP_ERROR_ARGUMENT;
  if (device->state != STATE_OPEN && device->state != STATE_CONFIGURED &&
      device->state != STATE_LOADED) {
    return HVP_ERROR_STATE;
  }
  struct hvp_solver_config full = *config;
  fill_in(&full);
  if (!possible(&full)) return HVP_ERROR_ARGUMENT;
  if (!within(&device->capability, &full)) return HVP_ERROR_CAPABILITY;
  if (full.one_a_word && device->minor_version < MINOR_VERSION_OF_PACKING) {
    return HVP_ERROR_CAPABILITY;
  }

  const uint32_t method = (uint32_t)full.method;
  const uint32_t format = format_of(&full);
  uint32_t* words = device->scratch;
  words[0] = method;
  words[1] = full.iterations;
  words[2] = (uint32_t)full.stop_residual;
  words[3] = (uint32_t)(full.stop_residual >> 32U);
  words[4] = full.replace_every;
  words[5] = full.static_shift;
  words[6] = scaling_of(&full);
  words[7] = format;
  words[8] = coefficients_of(&full);
  words[9] = arithmetic_of(&full);
  words[10] = (uint32_t)full.start;
  device->bus.write_block(device->bus.context, HVP_OFFSET(METHOD), words, SETTINGS_WORDS);

  // A register of its own, that a board without it is not asked for.
  const bool repacked = full.one_a_word != device->one_a_word;
  if (repacked) {
    hvp_write_register(device, HVP_OFFSET(PACKING),
                       full.one_a_word ? HVP_PACKING_MODE_ONE_A_WORD : HVP_PACKING_MODE_TWO_A_WORD);
    device->one_a_word = full.one_a_word;
  }

  if (device->state == STATE_OPEN || repacked || format != device->format ||
      method != device->method) {
    device->state = STATE_CONFIGURED;
  }
  device->format = format;
  device->method = method;
  device->reject_saturated = full.reject_saturated;
  return hvp_bus_errors(device);
}
