// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#ifndef HVP_MEMORY_H
#define HVP_MEMORY_H

#include "driver/hvp_bus.h"

// Accesses to words of memory that the board reaches: descriptors, b, U and the completion record.
// They are little-endian there, whatever the host's byte order; every access of the driver to such
// memory is one of these two. Registers and the board's memories go through the call-backs, which
// take values.

// True if the bytes of a word in memory are swapped. The driver's tests invert the compiler's
// answer, and with it the board's view of memory, to act as a host of the other byte order.
#if (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__) != defined(HVP_OTHER_BYTE_ORDER)
#define HVP_TURNED(word) __builtin_bswap32(word)
#else
#define HVP_TURNED(word) (word)
#endif

// Exactly one access to memory, because the board may write at any time.
static inline uint32_t hvp_load_word(const volatile uint32_t* memory) {
  const uint32_t word = *memory;
  return HVP_TURNED(word);
}

static inline void hvp_store_word(volatile uint32_t* memory, uint32_t value) {
  *memory = HVP_TURNED(value);
}

#endif
