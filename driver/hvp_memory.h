#ifndef HVP_MEMORY_H
#define HVP_MEMORY_H

#include "driver/hvp_bus.h"

// Words of memory that the board reaches by itself: descriptors, b, U and the completion record.
// They are little-endian there, whatever the host's byte order; every access of the driver to such
// memory is one of these two. Registers and the board's memories go through the call-backs, which
// are given values.

// Whether a word in memory is turned. The driver's tests ask for the reverse of what the compiler
// says, and turn the board's view of memory with it, to be a host of the other byte order.
#if (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__) != defined(HVP_OTHER_BYTE_ORDER)
#define HVP_TURNED(word) __builtin_bswap32(word)
#else
#define HVP_TURNED(word) (word)
#endif

// One access to memory: the board may write at any time.
static inline uint32_t hvp_load_word(const volatile uint32_t* memory) {
  const uint32_t word = *memory;
  return HVP_TURNED(word);
}

static inline void hvp_store_word(volatile uint32_t* memory, uint32_t value) {
  *memory = HVP_TURNED(value);
}

#endif
