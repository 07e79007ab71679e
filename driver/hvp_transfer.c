// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#include "driver/hvp_transfer.h"

uint32_t hvp_pack_word(const int32_t* elements, size_t n, size_t i, size_t per_word) {
  if (per_word == 1U) return (uint32_t)elements[i];
  const uint32_t low = (uint32_t)elements[i] & 0xffffU;
  const uint32_t high = i + 1U < n ? (uint32_t)elements[i + 1U] & 0xffffU : 0U;
  return low | high << 16U;
}

// Two's complement without leaning on the compiler's conversion of a value that does not fit.
static int32_t signed_element(uint32_t pattern, uint32_t sign) {
  const int64_t value = (int64_t)(pattern ^ sign) - (int64_t)sign;
  return (int32_t)value;
}

size_t hvp_unpack_word(uint32_t word, int32_t* elements, size_t n, size_t i, size_t per_word) {
  if (per_word == 1U) {
    elements[i] = signed_element(word, 0x80000000U);
    return i + 1U;
  }
  elements[i] = signed_element(word & 0xffffU, 0x8000U);
  if (i + 1U < n) elements[i + 1U] = signed_element(word >> 16U, 0x8000U);
  return i + 2U;
}

uint32_t hvp_read_register(const struct hvp_device* device, uint32_t offset) {
  return device->bus.read32(device->bus.context, offset);
}

void hvp_write_register(const struct hvp_device* device, uint32_t offset, uint32_t value) {
  device->bus.write32(device->bus.context, offset, value);
}

bool hvp_elements_fit(const int32_t* elements, size_t n, uint32_t bits) {
  const int64_t limit = (int64_t)1 << (bits - 1U);
  for (size_t i = 0; i < n; ++i) {
    if (elements[i] < -limit || elements[i] >= limit) return false;
  }
  return true;
}

size_t hvp_write_burst(struct hvp_device* device, uint32_t offset, const int32_t* elements,
                       size_t n, size_t first, uint32_t bits) {
  const size_t per_word = hvp_elements_per_word(device, bits);
  size_t done = first;
  size_t words = 0;
  for (; words < device->scratch_words && done < n; ++words, done += per_word) {
    device->scratch[words] = hvp_pack_word(elements, n, done, per_word);
  }
  // `first` is the end of a burst, and so of a word; two elements at most are in one.
  const size_t word = per_word == 2U ? first / 2U : first;
  device->bus.write_block(device->bus.context, offset + (uint32_t)(word * sizeof(uint32_t)),
                          device->scratch, words);
  return done < n ? done : n;
}

void hvp_write_elements(struct hvp_device* device, uint32_t offset, const int32_t* elements,
                        size_t n, uint32_t bits) {
  size_t done = 0;
  while (done < n) done = hvp_write_burst(device, offset, elements, n, done, bits);
}

void hvp_read_elements(struct hvp_device* device, uint32_t offset, int32_t* elements, size_t n,
                       uint32_t bits) {
  const size_t per_word = hvp_elements_per_word(device, bits);
  size_t done = 0;
  while (done < n) {
    size_t words = hvp_words_of(n - done, per_word);
    if (words > device->scratch_words) words = device->scratch_words;
    device->bus.read_block(device->bus.context, offset, device->scratch, words);
    for (size_t i = 0; i < words; ++i) {
      done = hvp_unpack_word(device->scratch[i], elements, n, done, per_word);
    }
    offset += (uint32_t)(words * sizeof(uint32_t));
  }
}
