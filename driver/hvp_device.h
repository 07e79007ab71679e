#ifndef HVP_DEVICE_H
#define HVP_DEVICE_H

#include "driver/hvp_transfer.h"

// What the parts of the driver share about a device: not for its users.

// A zeroed handle is a closed one. A board that did not come to an end with a matrix is lost until
// it is reset.
enum {
  STATE_CLOSED,
  STATE_OPEN,
  STATE_CONFIGURED,
  STATE_CHECKING,  // load_done was commanded, and the wait for it interrupted
  STATE_LOADED,
  STATE_RUNNING,
  STATE_LOST,
};

// A field of a register's word, and a value put where the field is, by PeakRDL's names.
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

// All that the board interrupts for, as bits of INTERRUPT_STATUS and of INTERRUPT_ENABLE.
#define HVP_INTERRUPTS (HVP__INTERRUPT_ENABLE__DONE_bm | HVP__INTERRUPT_ENABLE__ERROR_bm)
static_assert(HVP__INTERRUPT_ENABLE__DONE_bm == HVP__INTERRUPT_STATUS__DONE_bm &&
                  HVP__INTERRUPT_ENABLE__ERROR_bm == HVP__INTERRUPT_STATUS__ERROR_bm,
              "INTERRUPT_ENABLE masks INTERRUPT_STATUS bit by bit");

// Each keeps interrupts_on with what INTERRUPT_ENABLE holds then. Enables nothing where nobody
// waits for an interrupt, and writes only what hvp_irq() or a reset took away.
void hvp_enable_interrupts(struct hvp_device* device);
void hvp_disable_interrupts(struct hvp_device* device);
// The command that resets the board, and with it the enables.
void hvp_write_reset(struct hvp_device* device);

// Until the board reports the end of a command, or timeout_ns have passed. Keeps STATUS in
// last_status, takes the interrupt down and returns what the board reported.
hvp_status hvp_await_end(struct hvp_device* device, uint64_t timeout_ns);

// How one look for an end begins: sleeps until the interrupt, or lets time pass after a look in
// vain. `late` says whether the time is up.
hvp_status hvp_sleep(struct hvp_device* device, uint64_t begin, uint64_t timeout_ns, bool looked,
                     bool* late);

// Before the first look of a wait.
static inline void hvp_begin_wait(struct hvp_device* device) {
  device->timed_out = false;
  device->caller_error = 0;
}

// The board has ended: an interrupt that was waited for in vain was lost.
static inline void hvp_count_lost_interrupt(struct hvp_device* device) {
  if (device->timed_out) ++device->statistics.lost_interrupts;
}

// What STATUS, or a completion record, says has ended: keeps it, takes the interrupt down and
// returns what the board reported.
hvp_status hvp_take_end(struct hvp_device* device, uint32_t status);

// Takes down what a list has left up, before a command whose end STATUS.done announces.
void hvp_clear_done(struct hvp_device* device);

// With DMA: the list for the loaded matrix, and the registers that point to it.
hvp_status hvp_prepare_list(struct hvp_device* device);
// b into its segments; it has 3·nodes elements.
void hvp_fill_segments(struct hvp_device* device, const int32_t* b);
// U out of its segments.
void hvp_empty_segments(struct hvp_device* device, int32_t* u);
// The doorbell, and until its completion record is there.
void hvp_run_list(struct hvp_device* device);
hvp_status hvp_await_record(struct hvp_device* device, uint64_t timeout_ns);

// What the bus has recorded since the last time, as a status; HVP_OK where it records nothing.
hvp_status hvp_bus_errors(const struct hvp_device* device);

#endif
