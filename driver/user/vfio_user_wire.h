// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#ifndef HVP_VFIO_USER_WIRE_H
#define HVP_VFIO_USER_WIRE_H

#include <stdint.h>

// The messages between client and server, in the machine's byte order: QEMU,
// docs/interop/vfio-user.rst, and <linux/vfio.h>.
enum {
  WIRE_VERSION = 1,
  WIRE_DMA_MAP = 2,
  WIRE_DMA_UNMAP = 3,
  WIRE_REGION_INFO = 5,
  WIRE_IRQ_INFO = 7,
  WIRE_SET_IRQS = 8,
  WIRE_REGION_READ = 9,
  WIRE_REGION_WRITE = 10,
  WIRE_DEVICE_RESET = 13,
};

enum { WIRE_REPLY = 1, WIRE_TYPE = 15, WIRE_NO_REPLY = 16, WIRE_ERROR = 32 };

struct wire_header {
  uint16_t id;
  uint16_t command;
  uint32_t size;  // of header and body
  uint32_t flags;
  uint32_t error;
};

struct wire_version {
  uint16_t major;
  uint16_t minor;
};

enum { WIRE_MEMORY_READ = 1, WIRE_MEMORY_WRITE = 2 };

struct wire_map {
  uint32_t argsz;
  uint32_t flags;
  uint64_t offset;
  uint64_t address;
  uint64_t size;
};

struct wire_unmap {
  uint32_t argsz;
  uint32_t flags;
  uint64_t address;
  uint64_t size;
};

enum { WIRE_BAR0 = 0, WIRE_CONFIG = 7 };

struct wire_region {
  uint32_t argsz;
  uint32_t flags;
  uint32_t index;
  uint32_t capabilities;
  uint64_t size;
  uint64_t offset;
};

enum { WIRE_INTX = 0, WIRE_MSI = 1, WIRE_MSI_X = 2 };

struct wire_irq {
  uint32_t argsz;
  uint32_t flags;
  uint32_t index;
  uint32_t count;
};

enum {
  WIRE_DATA_NONE = 1,
  WIRE_DATA_EVENTFD = 4,
  WIRE_ACTION_UNMASK = 16,
  WIRE_ACTION_TRIGGER = 32,
};

struct wire_set_irqs {
  uint32_t argsz;
  uint32_t flags;
  uint32_t index;
  uint32_t start;
  uint32_t count;
};

struct wire_access {
  uint64_t offset;
  uint32_t region;
  uint32_t count;
};

#endif
