// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#ifndef HVP_BUS_H
#define HVP_BUS_H

#ifdef __KERNEL__
#include <linux/stddef.h>
#include <linux/types.h>
#else
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#endif

// The call-backs with which the driver reaches a board, and the memory that the board reaches.
// docs/driver.md says what they are in a kernel.
#ifdef __cplusplus
extern "C" {
#endif

// The results of wait_interrupt. Any negative number is the caller's own reason to give up waiting,
// such as -EINTR: the board is unchanged, the driver stores the number (hvp_caller_error()) and
// returns HVP_ERROR_INTERRUPTED.
enum { HVP_INTERRUPT = 0, HVP_INTERRUPT_TIMED_OUT = 1, HVP_INTERRUPT_BUS_FAILED = 2 };

// The errors that a bus has recorded, as bits of take_errors.
enum {
  HVP_BUS_MASTER_ABORT = 1,  // nobody answered an access: a write was lost, a read was all ones
  HVP_BUS_PARITY = 2,        // a word was damaged on its way, to the board or from it
};

// The way to one board. Offsets are bytes from the start of its BAR, multiples of four. The driver
// gives and takes values. The bus is little-endian: on a host of the other byte order a call-back
// swaps each word's bytes, in a block too. Writes may be posted but must arrive in order and before
// a later read is answered. No call-back may unwind (throw, longjmp) through the driver.
struct hvp_bus {
  void* context;
  uint32_t (*read32)(void* context, uint32_t offset);
  void (*write32)(void* context, uint32_t offset, uint32_t value);
  // `count` consecutive words, as one burst where the bus can.
  void (*read_block)(void* context, uint32_t offset, uint32_t* words, size_t count);
  void (*write_block)(void* context, uint32_t offset, const uint32_t* words, size_t count);
  // Blocks until the board's interrupt line is up; at once if it is up already, or has been since
  // the last wait. The line is a level that the driver takes down by writing INTERRUPT_STATUS. Null
  // where there is no interrupt: the driver then polls STATUS.
  int (*wait_interrupt)(void* context, uint64_t timeout_ns);
  // A clock that never runs backwards and moves on while registers are read.
  uint64_t (*now_ns)(void* context);
  // Optional, without wait_interrupt: lets time pass between two polls. If it is null, polls follow
  // each other directly, and with DMA the driver polls STATUS, whose reads take time, instead of
  // the record.
  void (*pause)(void* context);
  // True if the board's interrupts follow its writes to memory, as messages do. If not, they may
  // overtake them, as a wire does; the driver then reads STATUS, which pushes the writes ahead of
  // itself.
  bool interrupts_after_writes;
  // Returns and clears the errors on the bus since the last call: for PCI the error bits of the
  // bridge's status register. Optional; without it a lost write, a block of ones and a damaged word
  // are not detected.
  uint32_t (*take_errors)(void* context);
  // Optional, both or neither: exclude hvp_irq() and the thread from each other. The lock is taken
  // for two accesses at most, never during a call-back other than read32 and write32. Writes made
  // under it reach the board in the order in which it was taken. It is needed if hvp_irq() masks
  // the line.
  void (*lock)(void* context);
  void (*unlock)(void* context);
};

// A run of the host's memory that the board reaches at one address. Both are multiples of four
// bytes. Words are little-endian in memory on every host: the driver stores them so, and their
// bytes must not be swapped on the way.
struct hvp_segment {
  uint32_t* memory;
  uint64_t bus_address;
  uint32_t bytes;
};

// The numbers of words of a descriptor and of the completion record (DMA_LIST_LOW, DMA_RECORD_LOW
// in docs/registers.md).
#define HVP_DESCRIPTOR_WORDS 8U
#define HVP_RECORD_WORDS 8U

// The areas of memory that the engine uses.
typedef enum hvp_area {
  HVP_AREA_LIST,      // the processor writes, the board reads
  HVP_AREA_TO_BOARD,  // likewise: b
  HVP_AREA_TO_HOST,   // the board writes, the processor reads: U
  HVP_AREA_RECORD,    // the processor clears, the board writes, the processor reads
  HVP_AREA_VALUES,    // the processor writes, the board reads: new entries of the matrix
} hvp_area;

// The owner of memory from now on; the other side does not access it.
typedef enum hvp_owner { HVP_OWNER_DEVICE, HVP_OWNER_PROCESSOR } hvp_owner;

// Memory for the board's DMA engine, in use until hvp_use_dma() is called again or hvp_close(). The
// segments of a direction together hold b, or U, of the largest matrix that will be loaded.
struct hvp_dma {
  const struct hvp_segment* to_board;
  size_t to_board_count;
  const struct hvp_segment* to_host;
  size_t to_host_count;
  uint32_t* list;  // HVP_DESCRIPTOR_WORDS for each segment
  uint64_t list_address;
  uint32_t* record;  // HVP_RECORD_WORDS
  uint64_t record_address;
  // Optional: memory from which the board fetches new entries of the matrix (hvp_update_values()),
  // and a list of its own, HVP_DESCRIPTOR_WORDS for each of these segments, 65535 at most. A matrix
  // whose entries do not fit gets them by blocks, and so does a board whose register map is older
  // than version 2.4.
  const struct hvp_segment* values;
  size_t values_count;
  uint32_t* values_list;
  uint64_t values_list_address;
  // Optional, where memory is not coherent or accesses to it are reordered. The driver owns no
  // memory until it asks for it: PROCESSOR before it reads or writes `part`, DEVICE afterwards. A
  // part is in one segment, or in a list or the record, and is no longer than the words accessed.
  // A second PROCESSOR without a DEVICE in between orders what is read after it behind what was
  // read before.
  void* context;
  void (*sync)(void* context, hvp_area area, const struct hvp_segment* part, hvp_owner owner);
};

#ifdef __cplusplus
}
#endif

#endif
