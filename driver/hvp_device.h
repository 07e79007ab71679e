// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#ifndef HVP_DEVICE_H
#define HVP_DEVICE_H

#include "driver/hvp_transfer.h"

// The declarations that the driver's sources share about a device. They are not for its users.

// A zeroed handle is a closed one. A board whose load did not end is lost until it is reset.
enum {
  STATE_CLOSED,
  STATE_OPEN,
  STATE_CONFIGURED,
  STATE_CHECKING,  // load_done was commanded, and the wait for it was interrupted
  STATE_LOADED,
  STATE_UPDATING,  // update_values was commanded, and the wait for it was interrupted
  STATE_RUNNING,
  STATE_LOST,
};

// The value of a field in a register's word, and a value shifted into a field, by PeakRDL's names.
#define FIELD(word, name) (((word)&name##_bm) >> name##_bp)
#define PLACE(value, name) ((uint32_t)(value) << name##_bp & name##_bm)

static inline uint32_t matrix_bits(const struct hvp_device* device) {
  return FIELD(device->format, HVP__FORMAT__MATRIX_BITS);
}
static inline uint32_t vector_bits(const struct hvp_device* device) {
  return FIELD(device->format, HVP__FORMAT__VECTOR_BITS);
}
static inline uint32_t rhs_bits(const struct hvp_device* device) {
  return FIELD(device->format, HVP__FORMAT__RHS_BITS);
}

static inline bool hvp_between(uint32_t value, uint32_t least, uint32_t most) {
  return value >= least && value <= most;
}

// All the board's causes of interrupts, as bits of INTERRUPT_STATUS and of INTERRUPT_ENABLE.
#define HVP_INTERRUPTS (HVP__INTERRUPT_ENABLE__DONE_bm | HVP__INTERRUPT_ENABLE__ERROR_bm)
static_assert(HVP__INTERRUPT_ENABLE__DONE_bm == HVP__INTERRUPT_STATUS__DONE_bm &&
                  HVP__INTERRUPT_ENABLE__ERROR_bm == HVP__INTERRUPT_STATUS__ERROR_bm,
              "INTERRUPT_ENABLE masks INTERRUPT_STATUS bit by bit");

// Each stores the new value of INTERRUPT_ENABLE in interrupts_on. hvp_enable_interrupts() enables
// none without wait_interrupt, and writes only the bits that hvp_irq() or a reset cleared.
void hvp_enable_interrupts(struct hvp_device* device);
void hvp_disable_interrupts(struct hvp_device* device);
// The command that resets the board, and with it the enables.
void hvp_write_reset(struct hvp_device* device);

// Waits until the board reports the end of a command, or timeout_ns have passed. Stores STATUS in
// last_status, clears the interrupt and returns the board's error.
hvp_status hvp_await_end(struct hvp_device* device, uint64_t timeout_ns);

// Begins one poll for an end: sleeps until the interrupt, or lets time pass after a poll without
// success. `late` is set if the time is up.
hvp_status hvp_sleep(struct hvp_device* device, uint64_t begin, uint64_t timeout_ns, bool looked,
                     bool* late);

// To be called before the first poll of a wait.
static inline void hvp_begin_wait(struct hvp_device* device) {
  device->timed_out = false;
  device->caller_error = 0;
}

// The board has ended: if the wait for its interrupt timed out, the interrupt was lost.
static inline void hvp_count_lost_interrupt(struct hvp_device* device) {
  if (device->timed_out) ++device->statistics.lost_interrupts;
}

// Takes the end that STATUS, or a completion record, reports: stores it, clears the interrupt and
// returns the board's error.
hvp_status hvp_take_end(struct hvp_device* device, uint32_t status);

// Clears the INTERRUPT_STATUS.done that a list has left, before a command whose end STATUS.done
// announces.
void hvp_clear_done(struct hvp_device* device);

// With DMA, prepares the list for the loaded matrix and the registers that point to it.
hvp_status hvp_prepare_list(struct hvp_device* device);
// Copies 9·blocks entries of the matrix into their segments.
void hvp_fill_values(struct hvp_device* device, const int32_t* values);
// Copies b, of 3·nodes elements, into its segments.
void hvp_fill_segments(struct hvp_device* device, const int32_t* b);
// Copies U out of its segments.
void hvp_empty_segments(struct hvp_device* device, int32_t* u);
// Rings the doorbell; then waits until the completion record has arrived.
void hvp_run_list(struct hvp_device* device);
hvp_status hvp_await_record(struct hvp_device* device, uint64_t timeout_ns);

// The errors that the bus has recorded since the last call, as a status; HVP_OK without
// take_errors.
hvp_status hvp_bus_errors(const struct hvp_device* device);

#endif
