// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
// The call-backs of struct hvp_bus.
#include "driver/user/vfio_user_client.h"

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "driver/user/vfio_user_message.h"
#include "driver/user/vfio_user_wire.h"

// STATUS of the configuration space (PCI 3.0 §6.2.3).
enum { PCI_STATUS = 0x06, PCI_MASTER_ABORT = 1 << 13, PCI_PARITY = 1 << 15 };

int hvp_vfio_user_read_config(struct hvp_vfio_user* client, uint32_t offset, void* data,
                              uint32_t bytes) {
  return wire_read(client, WIRE_CONFIG, offset, data, bytes);
}

int hvp_vfio_user_write_config(struct hvp_vfio_user* client, uint32_t offset, const void* data,
                               uint32_t bytes) {
  return wire_write(client, WIRE_CONFIG, offset, data, bytes, false);
}

// Call-backs.

static struct hvp_vfio_user* client_of(void* context) { return context; }

static uint32_t bar_read32(void* context, uint32_t offset) {
  uint32_t value = 0;
  if (wire_read(client_of(context), WIRE_BAR0, offset, &value, sizeof value) != 0) {
    return UINT32_MAX;
  }
  return value;
}

static void bar_write32(void* context, uint32_t offset, uint32_t value) {
  (void)wire_write(client_of(context), WIRE_BAR0, offset, &value, sizeof value, true);
}

static size_t piece(const struct hvp_vfio_user* client, size_t words) {
  const size_t most = client->transfer_bytes / sizeof(uint32_t);
  return words < most ? words : most;
}

static void bar_read_block(void* context, uint32_t offset, uint32_t* words, size_t count) {
  struct hvp_vfio_user* client = client_of(context);
  while (count > 0) {
    const size_t part = piece(client, count);
    const uint32_t bytes = (uint32_t)(part * sizeof *words);
    if (wire_read(client, WIRE_BAR0, offset, words, bytes) != 0) memset(words, 0xff, bytes);
    offset += bytes;
    words += part;
    count -= part;
  }
}

static void bar_write_block(void* context, uint32_t offset, const uint32_t* words, size_t count) {
  struct hvp_vfio_user* client = client_of(context);
  while (count > 0) {
    const size_t part = piece(client, count);
    const uint32_t bytes = (uint32_t)(part * sizeof *words);
    (void)wire_write(client, WIRE_BAR0, offset, words, bytes, true);
    offset += bytes;
    words += part;
    count -= part;
  }
}

static int unmask(struct hvp_vfio_user* client) {
  struct wire_set_irqs set = {.argsz = sizeof set,
                              .flags = WIRE_DATA_NONE | WIRE_ACTION_UNMASK,
                              .index = WIRE_INTX,
                              .count = 1};
  client->masked = false;
  return wire_command(client, WIRE_SET_IRQS, &set, sizeof set, -1);
}

// INTx is masked since it was signalled last; if it is still up when it is unmasked, it is
// signalled again.
static int bar_wait_interrupt(void* context, uint64_t timeout_ns) {
  struct hvp_vfio_user* client = client_of(context);
  if (client->masked && unmask(client) != 0) return HVP_INTERRUPT_BUS_FAILED;
  if (client->error != 0) return HVP_INTERRUPT_BUS_FAILED;
  struct pollfd files[2] = {{.fd = client->interrupt, .events = POLLIN},
                            {.fd = client->socket, .events = POLLIN}};
  const struct timespec timeout = {.tv_sec = (time_t)(timeout_ns / 1000000000U),
                                   .tv_nsec = (long)(timeout_ns % 1000000000U)};
  const int ready = ppoll(files, 2, &timeout, NULL);
  if (ready < 0) return -errno;
  if (ready == 0) return HVP_INTERRUPT_TIMED_OUT;
  uint64_t count = 0;
  if ((files[0].revents & POLLIN) != 0 &&
      read(client->interrupt, &count, sizeof count) == (ssize_t)sizeof count) {
    client->masked = !client->messages;
    return HVP_INTERRUPT;
  }
  // The server says nothing unasked: it has gone.
  (void)wire_fail(client, EPIPE);
  return HVP_INTERRUPT_BUS_FAILED;
}

static uint64_t now_ns(void* context) {
  (void)context;
  struct timespec now = {0};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (uint64_t)now.tv_sec * 1000000000U + (uint64_t)now.tv_nsec;
}

static uint32_t take_errors(void* context) {
  struct hvp_vfio_user* client = client_of(context);
  uint16_t status = 0;
  if (hvp_vfio_user_read_config(client, PCI_STATUS, &status, sizeof status) != 0) {
    return HVP_BUS_MASTER_ABORT;
  }
  const uint16_t errors = status & (PCI_MASTER_ABORT | PCI_PARITY);
  if (errors == 0) return 0;
  (void)hvp_vfio_user_write_config(client, PCI_STATUS, &errors, sizeof errors);
  return ((errors & PCI_MASTER_ABORT) != 0 ? HVP_BUS_MASTER_ABORT : 0U) |
         ((errors & PCI_PARITY) != 0 ? HVP_BUS_PARITY : 0U);
}

struct hvp_bus hvp_vfio_user_bus(struct hvp_vfio_user* client) {
  return (struct hvp_bus){.context = client,
                          .read32 = bar_read32,
                          .write32 = bar_write32,
                          .read_block = bar_read_block,
                          .write_block = bar_write_block,
                          .wait_interrupt = bar_wait_interrupt,
                          .now_ns = now_ns,
                          .interrupts_after_writes = client->messages,
                          .take_errors = take_errors};
}
