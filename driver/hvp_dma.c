// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#include "driver/hvp_device.h"
#include "driver/hvp_memory.h"

enum { LIST_REGISTERS = 5, VALUES_REGISTERS = 3, LIST_ALIGNMENT = 32 };
enum { MINOR_VERSION_OF_DMA = 1, MINOR_VERSION_OF_FETCHED_VALUES = 4 };
static_assert(offsetof(hvp_t, DMA_RECORD_HIGH) - offsetof(hvp_t, DMA_LIST_LOW) ==
                  4 * (LIST_REGISTERS - 1),
              "one burst writes DMA_LIST_LOW to DMA_RECORD_HIGH");
static_assert(offsetof(hvp_t, DMA_VALUES_COUNT) - offsetof(hvp_t, DMA_LIST_LOW) ==
                  4 * (LIST_REGISTERS + VALUES_REGISTERS - 1),
              "or on to DMA_VALUES_COUNT");
#define MOST_VALUES_SEGMENTS (HVP__DMA_VALUES_COUNT__COUNT_bm >> HVP__DMA_VALUES_COUNT__COUNT_bp)

enum { DESCRIPTOR_TO_HOST = 1 };

// The words of a completion record.
enum {
  RECORD_STATUS,
  RECORD_BYTES_TO_BOARD,
  RECORD_BYTES_TO_HOST,
  RECORD_ITERATIONS,
  RECORD_FLAGS,
  RECORD_CYCLES_LOW,
  RECORD_CYCLES_HIGH,
  RECORD_JOB
};
static_assert(RECORD_JOB == (int)HVP_RECORD_WORDS - 1, "the job comes last");

static uint32_t bytes_of(const struct hvp_device* device, size_t n, uint32_t bits) {
  const size_t words = hvp_words_of(n, hvp_elements_per_word(device, bits));
  return (uint32_t)(words * sizeof(uint32_t));
}

static uint32_t bytes_of_values(const struct hvp_device* device) {
  return bytes_of(device, (size_t)9 * device->blocks, matrix_bits(device));
}

// How many of the segments `bytes` take; 0 if all of them are too small.
static size_t segments_for(const struct hvp_segment* segments, size_t count, uint32_t bytes) {
  uint64_t room = 0U;
  for (size_t i = 0; i < count; ++i) {
    room += segments[i].bytes;
    if (room >= bytes) return i + 1U;
  }
  return 0U;
}

static bool segments_are_sane(const struct hvp_segment* segments, size_t count) {
  if (segments == NULL || count == 0U) return false;
  for (size_t i = 0; i < count; ++i) {
    const struct hvp_segment* segment = &segments[i];
    if (segment->memory == NULL || segment->bytes == 0U || (segment->bytes & 3U) != 0U ||
        (segment->bus_address & 3U) != 0U || segment->bus_address + segment->bytes == 0U ||
        segment->bus_address + segment->bytes < segment->bus_address) {
      return false;
    }
  }
  return true;
}

static bool dma_is_sane(const struct hvp_dma* dma) {
  return dma->list != NULL && dma->record != NULL &&
         (dma->list_address & (LIST_ALIGNMENT - 1U)) == 0U &&
         (dma->record_address & (LIST_ALIGNMENT - 1U)) == 0U &&
         segments_are_sane(dma->to_board, dma->to_board_count) &&
         segments_are_sane(dma->to_host, dma->to_host_count) &&
         (dma->values_count == 0U ||
          (dma->values_list != NULL && (dma->values_list_address & (LIST_ALIGNMENT - 1U)) == 0U &&
           segments_are_sane(dma->values, dma->values_count)));
}

static void hand_over(const struct hvp_device* device, hvp_area area, struct hvp_segment part,
                      hvp_owner owner) {
  if (device->dma.sync != NULL) device->dma.sync(device->dma.context, area, &part, owner);
}

static void hand_over_record(const struct hvp_device* device, hvp_owner owner) {
  const struct hvp_dma* dma = &device->dma;
  const struct hvp_segment record = {dma->record, dma->record_address,
                                     HVP_RECORD_WORDS * (uint32_t)sizeof(uint32_t)};
  hand_over(device, HVP_AREA_RECORD, record, owner);
}

static void hand_over_list(const struct hvp_device* device, uint32_t* words, uint64_t address,
                           size_t descriptors, hvp_owner owner) {
  const struct hvp_segment list = {
      words, address, (uint32_t)(descriptors * HVP_DESCRIPTOR_WORDS * sizeof(uint32_t))};
  hand_over(device, HVP_AREA_LIST, list, owner);
}

// Of the segments, the first `bytes`.
static void hand_over_segments(const struct hvp_device* device, hvp_area area,
                               const struct hvp_segment* segments, uint32_t bytes,
                               hvp_owner owner) {
  for (uint32_t left = bytes; left > 0U; ++segments) {
    struct hvp_segment part = *segments;
    if (part.bytes > left) part.bytes = left;
    hand_over(device, area, part, owner);
    left -= part.bytes;
  }
}

// Descriptors for `bytes` behind `words`; returns where the next ones go.
static uint32_t* describe(uint32_t* words, const struct hvp_segment* segments, uint32_t bytes,
                          uint32_t control, uint32_t offset) {
  uint32_t left = bytes;
  for (size_t i = 0; left > 0U; ++i) {
    const uint32_t part = segments[i].bytes < left ? segments[i].bytes : left;
    const uint32_t descriptor[HVP_DESCRIPTOR_WORDS] = {
        control, part, (uint32_t)segments[i].bus_address,
        (uint32_t)(segments[i].bus_address >> 32U), offset};
    for (size_t k = 0; k < HVP_DESCRIPTOR_WORDS; ++k) hvp_store_word(&words[k], descriptor[k]);
    words += HVP_DESCRIPTOR_WORDS;
    offset += part;
    left -= part;
  }
  return words;
}

// The list of the loaded matrix' entries, and the registers that point to it. Returns how many
// registers those are: none where the entries go by blocks.
static size_t prepare_values(struct hvp_device* device, uint32_t* registers) {
  const struct hvp_dma* dma = &device->dma;
  device->bytes_of_values = 0U;
  if (dma->values_count == 0U || device->minor_version < MINOR_VERSION_OF_FETCHED_VALUES) return 0U;
  const uint32_t bytes = bytes_of_values(device);
  const size_t count = segments_for(dma->values, dma->values_count, bytes);
  if (count == 0U) return 0U;

  hand_over_list(device, dma->values_list, dma->values_list_address, count, HVP_OWNER_PROCESSOR);
  (void)describe(dma->values_list, dma->values, bytes, 0U, HVP_OFFSET(VALUE));
  hand_over_list(device, dma->values_list, dma->values_list_address, count, HVP_OWNER_DEVICE);
  device->bytes_of_values = bytes;
  registers[0] = (uint32_t)dma->values_list_address;
  registers[1] = (uint32_t)(dma->values_list_address >> 32U);
  registers[2] = PLACE(count, HVP__DMA_VALUES_COUNT__COUNT);
  return VALUES_REGISTERS;
}

hvp_status hvp_prepare_list(struct hvp_device* device) {
  const struct hvp_dma* dma = &device->dma;
  const size_t unknowns = (size_t)3 * device->nodes;
  const uint32_t to_board = bytes_of(device, unknowns, rhs_bits(device));
  const uint32_t to_host = bytes_of(device, unknowns, vector_bits(device));
  const size_t first = segments_for(dma->to_board, dma->to_board_count, to_board);
  const size_t second = segments_for(dma->to_host, dma->to_host_count, to_host);
  if (first == 0U || second == 0U) return HVP_ERROR_ARGUMENT;

  hand_over_list(device, dma->list, dma->list_address, first + second, HVP_OWNER_PROCESSOR);
  uint32_t* behind = describe(dma->list, dma->to_board, to_board, 0U, HVP_OFFSET(B));
  (void)describe(behind, dma->to_host, to_host, DESCRIPTOR_TO_HOST, HVP_OFFSET(U));
  hand_over_list(device, dma->list, dma->list_address, first + second, HVP_OWNER_DEVICE);
  device->bytes_to_board = to_board;
  device->bytes_to_host = to_host;

  uint32_t* words = device->scratch;
  words[0] = (uint32_t)dma->list_address;
  words[1] = (uint32_t)(dma->list_address >> 32U);
  words[2] = PLACE(first, HVP__DMA_COUNT__TO_BOARD) | PLACE(second, HVP__DMA_COUNT__TO_HOST);
  words[3] = (uint32_t)dma->record_address;
  words[4] = (uint32_t)(dma->record_address >> 32U);
  const size_t more = prepare_values(device, &words[LIST_REGISTERS]);
  device->bus.write_block(device->bus.context, HVP_OFFSET(DMA_LIST_LOW), words,
                          LIST_REGISTERS + more);
  return HVP_OK;
}

uint32_t hvp_dma_descriptors(const struct hvp_device* device) {
  if (device == NULL || device->state == STATE_CLOSED ||
      device->minor_version < MINOR_VERSION_OF_DMA) {
    return 0U;
  }
  return FIELD(hvp_read_register(device, HVP_OFFSET(CAPABILITY_DMA)),
               HVP__CAPABILITY_DMA__MAX_DESCRIPTORS);
}

hvp_status hvp_use_dma(struct hvp_device* device, const struct hvp_dma* dma) {
  if (device == NULL) return HVP_ERROR_ARGUMENT;
  if (device->state != STATE_OPEN && device->state != STATE_CONFIGURED &&
      device->state != STATE_LOADED) {
    return HVP_ERROR_STATE;
  }
  if (dma == NULL) {
    device->uses_dma = false;
    return HVP_OK;
  }
  if (!dma_is_sane(dma)) return HVP_ERROR_ARGUMENT;
  const uint32_t most = hvp_dma_descriptors(device);
  if (dma->to_board_count > most || dma->to_host_count > most - dma->to_board_count ||
      dma->values_count > MOST_VALUES_SEGMENTS) {
    return HVP_ERROR_CAPABILITY;
  }
  const bool used = device->uses_dma;
  const struct hvp_dma before = device->dma;
  device->dma = *dma;
  device->uses_dma = true;
  if (device->state != STATE_LOADED) return HVP_OK;
  const hvp_status status = hvp_prepare_list(device);
  if (status != HVP_OK) {
    device->dma = before;
    device->uses_dma = used;
  }
  return status;
}

// Packs n elements of `bits` bits, which are `bytes` then, into the segments of an area.
static void fill(struct hvp_device* device, hvp_area area, const struct hvp_segment* segments,
                 uint32_t bytes, const int32_t* elements, size_t n, uint32_t bits) {
  const size_t per_word = hvp_elements_per_word(device, bits);
  const struct hvp_segment* segment = segments;
  hand_over_segments(device, area, segments, bytes, HVP_OWNER_PROCESSOR);
  size_t word = 0;
  for (size_t i = 0; i < n; i += per_word) {
    if (word == segment->bytes >> 2U) {
      ++segment;
      word = 0;
    }
    hvp_store_word(&segment->memory[word], hvp_pack_word(elements, n, i, per_word));
    ++word;
  }
  hand_over_segments(device, area, segments, bytes, HVP_OWNER_DEVICE);
}

void hvp_fill_segments(struct hvp_device* device, const int32_t* b) {
  fill(device, HVP_AREA_TO_BOARD, device->dma.to_board, device->bytes_to_board, b,
       (size_t)3 * device->nodes, rhs_bits(device));
}

void hvp_fill_values(struct hvp_device* device, const int32_t* values) {
  fill(device, HVP_AREA_VALUES, device->dma.values, device->bytes_of_values, values,
       (size_t)9 * device->blocks, matrix_bits(device));
}

void hvp_empty_segments(struct hvp_device* device, int32_t* u) {
  const size_t n = (size_t)3 * device->nodes;
  const size_t per_word = hvp_elements_per_word(device, vector_bits(device));
  const struct hvp_segment* segment = device->dma.to_host;
  hand_over_segments(device, HVP_AREA_TO_HOST, segment, device->bytes_to_host, HVP_OWNER_PROCESSOR);
  size_t word = 0;
  for (size_t i = 0; i < n;) {
    if (word == segment->bytes >> 2U) {
      ++segment;
      word = 0;
    }
    i = hvp_unpack_word(hvp_load_word(&segment->memory[word]), u, n, i, per_word);
    ++word;
  }
  hand_over_segments(device, HVP_AREA_TO_HOST, device->dma.to_host, device->bytes_to_host,
                     HVP_OWNER_DEVICE);
}

size_t hvp_dma_values_bytes(const struct hvp_device* device) {
  if (device == NULL || device->state != STATE_LOADED || !device->uses_dma ||
      device->minor_version < MINOR_VERSION_OF_FETCHED_VALUES) {
    return 0U;
  }
  return bytes_of_values(device);
}

void hvp_run_list(struct hvp_device* device) {
  // Job numbers begin anew after a reset: an old record must not pass for the new one.
  hand_over_record(device, HVP_OWNER_PROCESSOR);
  for (size_t k = 0; k < HVP_RECORD_WORDS; ++k) hvp_store_word(&device->dma.record[k], 0U);
  hand_over_record(device, HVP_OWNER_DEVICE);
  hvp_write_register(device, HVP_OFFSET(CONTROL), HVP__CONTROL__RUN_LIST_bm);
  device->done_pending = false;
}

// The completion record, if it is this job's. The board writes its job last, and so the rest is
// read after it.
static bool read_record(const struct hvp_device* device, uint32_t* record) {
  const uint32_t* words = device->dma.record;
  hand_over_record(device, HVP_OWNER_PROCESSOR);
  const bool there = hvp_load_word(&words[RECORD_JOB]) == device->job;
  if (there) {
    hand_over_record(device, HVP_OWNER_PROCESSOR);
    for (size_t k = 0; k < HVP_RECORD_WORDS; ++k) record[k] = hvp_load_word(&words[k]);
  }
  hand_over_record(device, HVP_OWNER_DEVICE);
  return there;
}

static hvp_status take_record(struct hvp_device* device, const uint32_t* record, bool line_is_up) {
  hvp_count_lost_interrupt(device);
  const uint32_t status = record[RECORD_STATUS];
  if ((status & HVP__STATUS__ERROR_bm) != 0U) return hvp_take_end(device, status);
  if ((status & HVP__STATUS__DONE_bm) == 0U) return HVP_ERROR_STALE_RESULT;
  if (line_is_up) {
    (void)hvp_take_end(device, status);
    // Nothing follows that would tell of an acknowledgement that was lost.
    if (hvp_bus_errors(device) != HVP_OK) {
      (void)hvp_take_end(device, status);
      ++device->statistics.lost_acknowledgements;
    }
  } else {
    device->last_status = status;
    device->done_pending = true;
  }
  if (record[RECORD_BYTES_TO_BOARD] != device->bytes_to_board ||
      record[RECORD_BYTES_TO_HOST] != device->bytes_to_host) {
    return HVP_ERROR_SHORT_TRANSFER;
  }
  return HVP_OK;
}

// Normally the interrupt, or a look at the memory, and the record: no register is read unless the
// interrupt may have overtaken the record, or the record is not there.
hvp_status hvp_await_record(struct hvp_device* device, uint64_t timeout_ns) {
  const struct hvp_bus* bus = &device->bus;
  const bool line = bus->wait_interrupt != NULL && !bus->interrupts_after_writes;
  const bool polls_memory = bus->wait_interrupt == NULL && bus->pause != NULL;
  const uint64_t begin = bus->now_ns(bus->context);
  uint32_t record[HVP_RECORD_WORDS];
  hvp_begin_wait(device);
  for (bool looked = false;; looked = true) {
    bool late;
    const hvp_status slept = hvp_sleep(device, begin, timeout_ns, looked, &late);
    if (slept != HVP_OK) return slept;
    // After a time-out the board is asked as well: an interrupt is missing, and it may be the board
    // that is.
    if (!line && !late && read_record(device, record)) return take_record(device, record, false);
    if (polls_memory && !late) continue;
    // This read is answered behind everything that the board has written before.
    const uint32_t status = hvp_read_register(device, HVP_OFFSET(STATUS));
    if (status == HVP_ALL_ONES) return HVP_ERROR_BUS;
    if (read_record(device, record)) return take_record(device, record, line);
    if ((status & HVP__STATUS__ERROR_bm) != 0U) return hvp_take_end(device, status);
    if ((status & HVP__STATUS__DONE_bm) != 0U) {
      (void)hvp_take_end(device, status);
      return HVP_ERROR_STALE_RESULT;
    }
    if (late) return HVP_ERROR_TIMEOUT;
  }
}
