// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#include "driver/hvp_driver.h"

#include "driver/hvp_device.h"

enum { KNOWN_MAJOR_VERSION = 2 };

// What an error leaves behind: its detail, and the true job number, since a refused start did not
// count. Read before the error is cleared, which clears the detail too.
static void note_error(struct hvp_device* device) {
  device->error_detail = hvp_read_register(device, HVP_OFFSET(ERROR_DETAIL));
  device->job = hvp_read_register(device, HVP_OFFSET(JOB));
}

hvp_status hvp_bus_errors(const struct hvp_device* device) {
  if (device->bus.take_errors == NULL) return HVP_OK;
  return hvp_status_of_bus(device->bus.take_errors(device->bus.context));
}

hvp_status hvp_sleep(struct hvp_device* device, uint64_t begin, uint64_t timeout_ns, bool looked,
                     bool* late) {
  const struct hvp_bus* bus = &device->bus;
  hvp_enable_interrupts(device);
  if (bus->wait_interrupt == NULL && bus->pause != NULL && looked) bus->pause(bus->context);
  const uint64_t elapsed = bus->now_ns(bus->context) - begin;
  *late = elapsed >= timeout_ns;
  if (bus->wait_interrupt != NULL && !*late) {
    const int outcome = bus->wait_interrupt(bus->context, timeout_ns - elapsed);
    if (outcome < 0) {
      device->caller_error = outcome;
      return HVP_ERROR_INTERRUPTED;
    }
    if (outcome != HVP_INTERRUPT && outcome != HVP_INTERRUPT_TIMED_OUT) return HVP_ERROR_BUS;
    *late = outcome == HVP_INTERRUPT_TIMED_OUT;
    device->timed_out = *late;
  }
  return HVP_OK;
}

hvp_status hvp_take_end(struct hvp_device* device, uint32_t status) {
  device->last_status = status;
  const bool failed = (status & HVP__STATUS__ERROR_bm) != 0U;
  if (failed) note_error(device);
  const uint32_t seen = PLACE(FIELD(status, HVP__STATUS__DONE), HVP__INTERRUPT_STATUS__DONE) |
                        PLACE(FIELD(status, HVP__STATUS__ERROR), HVP__INTERRUPT_STATUS__ERROR);
  hvp_write_register(device, HVP_OFFSET(INTERRUPT_STATUS), seen);
  device->done_pending = false;
  return failed ? hvp_status_of_board(FIELD(status, HVP__STATUS__ERROR_CODE)) : HVP_OK;
}

void hvp_clear_done(struct hvp_device* device) {
  if (!device->done_pending) return;
  hvp_write_register(device, HVP_OFFSET(INTERRUPT_STATUS), HVP__INTERRUPT_STATUS__DONE_bm);
  device->done_pending = false;
}

hvp_status hvp_await_end(struct hvp_device* device, uint64_t timeout_ns) {
  const uint64_t begin = device->bus.now_ns(device->bus.context);
  hvp_begin_wait(device);
  for (bool looked = false;; looked = true) {
    bool late;
    const hvp_status slept = hvp_sleep(device, begin, timeout_ns, looked, &late);
    if (slept != HVP_OK) return slept;
    // The line may be shared or its interrupt lost: STATUS alone decides.
    const uint32_t status = hvp_read_register(device, HVP_OFFSET(STATUS));
    if (status == HVP_ALL_ONES) return HVP_ERROR_BUS;
    const uint32_t ended = status & (HVP__STATUS__DONE_bm | HVP__STATUS__ERROR_bm);
    if (ended == HVP__STATUS__DONE_bm && (status & HVP__STATUS__BUSY_bm) != 0U) {
      // Of an earlier command, whose acknowledgement did not arrive.
      hvp_write_register(device, HVP_OFFSET(INTERRUPT_STATUS), HVP__INTERRUPT_STATUS__DONE_bm);
      ++device->statistics.lost_acknowledgements;
    } else if (ended != 0U) {
      hvp_count_lost_interrupt(device);
      return hvp_take_end(device, status);
    }
    if (late) return HVP_ERROR_TIMEOUT;
  }
}

static void read_capability(struct hvp_device* device) {
  struct hvp_capability* capability = &device->capability;
  const uint32_t nodes = hvp_read_register(device, HVP_OFFSET(CAPABILITY_NODES));
  capability->max_nodes = FIELD(nodes, HVP__CAPABILITY_NODES__MAX_NODES);
  capability->max_row_blocks = FIELD(nodes, HVP__CAPABILITY_NODES__MAX_ROW_BLOCKS);
  capability->max_blocks = hvp_read_register(device, HVP_OFFSET(CAPABILITY_BLOCKS));
  const uint32_t format = hvp_read_register(device, HVP_OFFSET(CAPABILITY_FORMAT));
  capability->max_matrix_bits = FIELD(format, HVP__CAPABILITY_FORMAT__MAX_MATRIX_BITS);
  capability->max_vector_bits = FIELD(format, HVP__CAPABILITY_FORMAT__MAX_VECTOR_BITS);
  capability->max_rhs_bits = FIELD(format, HVP__CAPABILITY_FORMAT__MAX_RHS_BITS);
  capability->max_coefficient_bits = FIELD(format, HVP__CAPABILITY_FORMAT__MAX_COEFFICIENT_BITS);
  capability->clock_khz = hvp_read_register(device, HVP_OFFSET(CAPABILITY_CLOCK));
  const uint32_t solver = hvp_read_register(device, HVP_OFFSET(CAPABILITY_SOLVER));
  capability->methods = FIELD(solver, HVP__CAPABILITY_SOLVER__METHODS);
  capability->start_modes = FIELD(solver, HVP__CAPABILITY_SOLVER__START_MODES);
  capability->max_scalar_bits = FIELD(solver, HVP__CAPABILITY_SOLVER__MAX_SCALAR_BITS);
}

// The map has room for this much; a board that claims more is not one of ours.
static bool capability_is_sane(const struct hvp_capability* capability) {
  const uint32_t most_nodes = (uint32_t)(sizeof(hvp__B_t) / sizeof(uint32_t) / 3U);
  const uint32_t most_row_blocks = (uint32_t)(sizeof(hvp__ROW_t) / sizeof(uint32_t) / 9U);
  const uint32_t most_blocks = (uint32_t)(sizeof(hvp__COLUMN_t) / sizeof(uint32_t));
  return hvp_between(capability->max_nodes, 1U, most_nodes) &&
         hvp_between(capability->max_row_blocks, 1U, most_row_blocks) &&
         hvp_between(capability->max_blocks, 1U, most_blocks) &&
         hvp_between(capability->max_matrix_bits, 2U, 32U) &&
         hvp_between(capability->max_vector_bits, 2U, 32U) &&
         hvp_between(capability->max_rhs_bits, 2U, 32U) &&
         hvp_between(capability->max_coefficient_bits, 2U, 32U) && capability->clock_khz != 0U &&
         capability->methods != 0U && capability->start_modes != 0U &&
         capability->max_scalar_bits >= 64U;
}

hvp_status hvp_open(struct hvp_device* device, const struct hvp_bus* bus, uint32_t* scratch,
                    size_t scratch_words) {
  if (device == NULL || bus == NULL || scratch == NULL) return HVP_ERROR_ARGUMENT;
  if (bus->read32 == NULL || bus->write32 == NULL || bus->read_block == NULL ||
      bus->write_block == NULL || bus->now_ns == NULL) {
    return HVP_ERROR_ARGUMENT;
  }
  if ((bus->lock == NULL) != (bus->unlock == NULL)) return HVP_ERROR_ARGUMENT;
  if (scratch_words < HVP_MIN_SCRATCH_WORDS) return HVP_ERROR_ARGUMENT;
  *device = (struct hvp_device){.bus = *bus, .scratch = scratch, .scratch_words = scratch_words};

  if (hvp_read_register(device, HVP_OFFSET(ID)) != HVP__ID__MAGIC_reset) {
    return HVP_ERROR_NO_DEVICE;
  }
  const uint32_t version = hvp_read_register(device, HVP_OFFSET(VERSION));
  if (FIELD(version, HVP__VERSION__MAJOR) != KNOWN_MAJOR_VERSION) return HVP_ERROR_VERSION;
  device->minor_version = FIELD(version, HVP__VERSION__MINOR);
  read_capability(device);
  if (!capability_is_sane(&device->capability)) return HVP_ERROR_CAPABILITY;

  device->state = STATE_OPEN;
  const hvp_status status = hvp_reset(device);
  if (status != HVP_OK) device->state = STATE_CLOSED;
  return status;
}

hvp_status hvp_reset(struct hvp_device* device) {
  if (device == NULL) return HVP_ERROR_ARGUMENT;
  if (device->state == STATE_CLOSED) return HVP_ERROR_STATE;
  hvp_write_reset(device);
  device->state = STATE_OPEN;
  device->format = 0U;
  device->method = 0U;
  device->nodes = 0U;
  device->job = 0U;
  device->last_status = 0U;
  device->error_detail = 0U;
  device->one_a_word = false;
  device->done_pending = false;
  device->reject_saturated = false;
  // What went wrong before is over.
  (void)hvp_bus_errors(device);
  const uint32_t status = hvp_read_register(device, HVP_OFFSET(STATUS));
  if (status == HVP_ALL_ONES) return HVP_ERROR_BUS;
  if (status != 0U) return HVP_ERROR_BOARD;
  hvp_enable_interrupts(device);
  return hvp_bus_errors(device);
}

hvp_status hvp_close(struct hvp_device* device) {
  if (device == NULL) return HVP_ERROR_ARGUMENT;
  if (device->state == STATE_CLOSED) return HVP_ERROR_STATE;
  hvp_disable_interrupts(device);
  device->state = STATE_CLOSED;
  return HVP_OK;
}

const struct hvp_capability* hvp_capability_of(const struct hvp_device* device) {
  return device == NULL ? NULL : &device->capability;
}
