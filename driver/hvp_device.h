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

// Until the board reports the end of a command, or timeout_ns have passed. Keeps STATUS in
// last_status, takes the interrupt down and returns what the board reported.
hvp_status hvp_await_end(struct hvp_device* device, uint64_t timeout_ns);

// How one look for an end begins: sleeps until the interrupt, or lets time pass after a look in
// vain. `late` says whether the time is up.
hvp_status hvp_sleep(struct hvp_device* device, uint64_t begin, uint64_t timeout_ns, bool looked,
                     bool* late);

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
void hvp_empty_segments(const struct hvp_device* device, int32_t* u);
// The doorbell, and until its completion record is there.
void hvp_run_list(struct hvp_device* device);
hvp_status hvp_await_record(struct hvp_device* device, uint64_t timeout_ns);

// What the bus has recorded since the last time, as a status; HVP_OK where it records nothing.
hvp_status hvp_bus_errors(const struct hvp_device* device);

#endif
