// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#ifndef HVP_TRANSFER_H
#define HVP_TRANSFER_H

#include "driver/generated/hvp_registers.h"
#include "driver/hvp_driver.h"

// Registers and packed elements over the bus: the driver's own, not for its users.

#define HVP_OFFSET(name) ((uint32_t)offsetof(hvp_t, name))

// The result of a read that no target answers.
#define HVP_ALL_ONES 0xffffffffU

uint32_t hvp_read_register(const struct hvp_device* device, uint32_t offset);
void hvp_write_register(const struct hvp_device* device, uint32_t offset, uint32_t value);

// True if all elements are signed words of `bits` bits, 2 to 32.
bool hvp_elements_fit(const int32_t* elements, size_t n, uint32_t bits);

// Elements of at most 16 bits travel two in a word unless the board was told otherwise (FORMAT and
// PACKING in docs/registers.md).
static inline size_t hvp_elements_per_word(const struct hvp_device* device, uint32_t bits) {
  return bits <= 16U && !device->one_a_word ? 2U : 1U;
}
// The number of words for n elements.
static inline size_t hvp_words_of(size_t n, size_t per_word) {
  return per_word == 2U ? (n + 1U) >> 1U : n;
}
// The word that begins with element i of n.
uint32_t hvp_pack_word(const int32_t* elements, size_t n, size_t i, size_t per_word);
// The elements of a word that begins with element i of n; returns the next i.
size_t hvp_unpack_word(uint32_t word, int32_t* elements, size_t n, size_t i, size_t per_word);

// Packs and writes elements, in as few bursts as the scratch area allows. `elements` must fit.
void hvp_write_elements(struct hvp_device* device, uint32_t offset, const int32_t* elements,
                        size_t n, uint32_t bits);

// Writes one such burst, from element `first` on, which must be the begin of a burst of the same
// array. Returns the next element.
size_t hvp_write_burst(struct hvp_device* device, uint32_t offset, const int32_t* elements,
                       size_t n, size_t first, uint32_t bits);

// Reads and unpacks elements.
void hvp_read_elements(struct hvp_device* device, uint32_t offset, int32_t* elements, size_t n,
                       uint32_t bits);

#endif
