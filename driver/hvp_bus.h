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

// What the driver is given to reach a board, and memory that the board reaches: the call-backs of a
// port. docs/driver.md says what they are in a kernel.
#ifdef __cplusplus
extern "C" {
#endif

// How wait_interrupt ended. Any negative number is the caller's own reason to give up waiting, as
// -EINTR is: the board is as it was, the driver keeps the number (hvp_caller_error()) and returns
// HVP_ERROR_INTERRUPTED.
enum { HVP_INTERRUPT = 0, HVP_INTERRUPT_TIMED_OUT = 1, HVP_INTERRUPT_BUS_FAILED = 2 };

// What a bus has recorded: bits of take_errors.
enum {
  HVP_BUS_MASTER_ABORT = 1,  // nobody answered an access: a write was lost, a read was all ones
  HVP_BUS_PARITY = 2,        // a word was damaged on its way, to the board or from it
};

// The way to one board. Offsets are bytes from the start of its BAR, multiples of four. The driver
// gives and takes values; a call-back knows the bus, which is little-endian, and its host: on one
// of the other byte order it turns each word, in a block too. Writes may be posted but must arrive
// in order and before a later read is answered. No call-back may unwind (throw, longjmp) through
// the driver.
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
  // Optional, without wait_interrupt: lets time pass between two polls. Null: a poll follows the
  // other, and with DMA it is STATUS that is polled, whose reads take time, not the record.
  void (*pause)(void* context);
  // The board's interrupts follow its writes to memory, as messages do. False: they may overtake
  // them, as a wire does; the driver then reads STATUS, which pushes the writes ahead of itself.
  bool interrupts_after_writes;
  // What went wrong on the bus since the last call, and forgets it: for PCI the error bits of the
  // bridge's status register. Optional. Without it a lost write, a block of ones and a damaged word
  // look like any other.
  uint32_t (*take_errors)(void* context);
  // Optional, both or none: keep hvp_irq() and the thread from each other. Taken for two accesses
  // at most, never across another call-back than read32 and write32. Writes made under it reach the
  // board in the order in which it was taken. Needed where hvp_irq() masks the line.
  void (*lock)(void* context);
  void (*unlock)(void* context);
};

// A run of the host's memory that the board reaches at one address. Both are multiples of four
// bytes. Words are little-endian in memory on every host: the driver sees to it, and nothing on the
// way may turn them.
struct hvp_segment {
  uint32_t* memory;
  uint64_t bus_address;
  uint32_t bytes;
};

// Words of a descriptor and of the completion record (DMA_LIST_LOW, DMA_RECORD_LOW in
// docs/registers.md).
#define HVP_DESCRIPTOR_WORDS 8U
#define HVP_RECORD_WORDS 8U

// Memory that the engine uses, and who does what to it.
typedef enum hvp_area {
  HVP_AREA_LIST,      // the processor writes, the board reads
  HVP_AREA_TO_BOARD,  // likewise: b
  HVP_AREA_TO_HOST,   // the board writes, the processor reads: U
  HVP_AREA_RECORD,    // the processor clears, the board writes, the processor reads
} hvp_area;

// Whose memory is from now on: the other one does not touch it.
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
  // Optional, where memory is not coherent or accesses to it are reordered. The driver owns no
  // memory until it asks for it: PROCESSOR before it reads or writes `part`, DEVICE when it has
  // done so. A part is in one segment, or is the list's or the record's words, and is no longer
  // than what is touched. A second PROCESSOR without a DEVICE in between orders what is read after
  // it behind what was read before.
  void* context;
  void (*sync)(void* context, hvp_area area, const struct hvp_segment* part, hvp_owner owner);
};

#ifdef __cplusplus
}
#endif

#endif
