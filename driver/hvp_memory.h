#ifndef HVP_MEMORY_H
#define HVP_MEMORY_H

#include "driver/hvp_driver.h"

// Words of memory that the board reaches by itself: descriptors, b, U and the completion record.
// They are little-endian there, whatever the host's byte order; every access of the driver to such
// memory is one of these two. Registers and the board's memories go through the call-backs, which
// are given values.

// Which of a word's bytes in memory is the least significant one: the first. The driver's tests set
// it to the last, and the board's view of memory with it, to be a host of the other byte order.
#ifndef HVP_LEAST_BYTE
#define HVP_LEAST_BYTE 0U
#endif

// One access to memory: the board may write at any time.
static inline uint32_t hvp_load_word(const volatile uint32_t* memory) {
  const uint32_t word = *memory;
  const uint8_t* byte = (const uint8_t*)&word;
  uint32_t value = 0U;
  for (unsigned k = 0U; k < 4U; ++k) value |= (uint32_t)byte[k ^ HVP_LEAST_BYTE] << 8U * k;
  return value;
}

static inline void hvp_store_word(uint32_t* memory, uint32_t value) {
  uint32_t word = 0U;
  uint8_t* byte = (uint8_t*)&word;
  for (unsigned k = 0U; k < 4U; ++k) byte[k ^ HVP_LEAST_BYTE] = (uint8_t)(value >> 8U * k & 0xffU);
  *memory = word;
}

#endif
