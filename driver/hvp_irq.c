// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#include "driver/hvp_device.h"

// The interrupt's top half and its mask.
//
// `interrupts_on` is what INTERRUPT_ENABLE was last told; both change together and under the lock,
// and writes under the lock arrive in the lock's order, so that they never differ for the board.
//
// The handler masks only what it then reports: each HVP_IRQ_MINE is one wake-up, which
// wait_interrupt keeps until a wait takes it. Whatever raised the line is still in
// INTERRUPT_STATUS, since only the thread clears it. So wherever the handler comes between the
// thread's accesses:
//  - before the thread acknowledges: the thread is woken, finds the end in STATUS and clears it; or
//    it has found it already, and the wake-up ends a later wait early, at the cost of one look.
//  - after the acknowledgement: nothing of this board is up, the handler touches nothing.
//  - while the line is masked, for a neighbour on it or because the masking write is still on its
//    way: `interrupts_on` says so, the handler touches nothing and masks nothing twice.
// The thread enables interrupts again behind each start of a job and before each wait, not when it
// acknowledges: a list may leave `done` up until the next one clears it. What ended before that
// raises the line at that very write, since the line is a level. So an end is never behind a mask
// that nobody takes away: whoever waits, or is told by hvp_irq() alone after a start, hears of it.

static void lock(const struct hvp_device* device) {
  if (device->bus.lock != NULL) device->bus.lock(device->bus.context);
}

static void unlock(const struct hvp_device* device) {
  if (device->bus.unlock != NULL) device->bus.unlock(device->bus.context);
}

int hvp_irq(struct hvp_device* device, bool line) {
  if (device == NULL) return HVP_IRQ_NONE;
  if (!line) return HVP_IRQ_MINE;
  int outcome = HVP_IRQ_NONE;
  lock(device);
  if (device->interrupts_on) {
    const uint32_t status = hvp_read_register(device, HVP_OFFSET(INTERRUPT_STATUS));
    if (status != HVP_ALL_ONES && (status & HVP_INTERRUPTS) != 0U) {
      hvp_write_register(device, HVP_OFFSET(INTERRUPT_ENABLE), 0U);
      device->interrupts_on = false;
      outcome = HVP_IRQ_MINE;
    }
  }
  unlock(device);
  return outcome;
}

void hvp_enable_interrupts(struct hvp_device* device) {
  if (device->bus.wait_interrupt == NULL) return;
  lock(device);
  if (!device->interrupts_on) {
    hvp_write_register(device, HVP_OFFSET(INTERRUPT_ENABLE), HVP_INTERRUPTS);
    device->interrupts_on = true;
  }
  unlock(device);
}

void hvp_disable_interrupts(struct hvp_device* device) {
  lock(device);
  hvp_write_register(device, HVP_OFFSET(INTERRUPT_ENABLE), 0U);
  device->interrupts_on = false;
  unlock(device);
}

void hvp_write_reset(struct hvp_device* device) {
  lock(device);
  hvp_write_register(device, HVP_OFFSET(CONTROL), HVP__CONTROL__RESET_bm);
  device->interrupts_on = false;
  unlock(device);
}
