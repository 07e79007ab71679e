// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#include "driver/hvp_device.h"

static_assert(offsetof(hvp_t, BLOCKS) - offsetof(hvp_t, NODES) == 4, "one burst writes both");

enum { UPDATE_WORDS = 4, MINOR_VERSION_OF_VALUES = 3 };
static_assert(offsetof(hvp_t, UPDATE_BLOCKS) - offsetof(hvp_t, UPDATE_NODE) ==
                  4 * (UPDATE_WORDS - 1),
              "one burst writes UPDATE_NODE to UPDATE_BLOCKS");

// What the board checks at load_done, before anything is sent.
static hvp_status check_matrix(const struct hvp_device* device, const struct hvp_matrix* matrix) {
  const struct hvp_capability* capability = &device->capability;
  if (matrix->nodes == 0U || matrix->blocks == 0U) return HVP_ERROR_BAD_SIZE;
  if (matrix->nodes > capability->max_nodes || matrix->blocks > capability->max_blocks) {
    return HVP_ERROR_CAPABILITY;
  }
  if (matrix->row_begin[0] != 0 || (uint32_t)matrix->row_begin[matrix->nodes] != matrix->blocks) {
    return HVP_ERROR_BAD_MATRIX;
  }
  for (uint32_t row = 0; row < matrix->nodes; ++row) {
    const int32_t begin = matrix->row_begin[row];
    const int32_t end = matrix->row_begin[row + 1U];
    if (end <= begin || (uint32_t)end > matrix->blocks) return HVP_ERROR_BAD_MATRIX;
    if ((uint32_t)(end - begin) > capability->max_row_blocks) return HVP_ERROR_CAPABILITY;
    bool diagonal = false;
    for (int32_t k = begin; k < end; ++k) {
      const int32_t column = matrix->column[k];
      if (column < 0 || (uint32_t)column >= matrix->nodes) return HVP_ERROR_BAD_MATRIX;
      if (k > begin && column <= matrix->column[k - 1]) return HVP_ERROR_BAD_MATRIX;
      diagonal = diagonal || (uint32_t)column == row;
    }
    if (!diagonal) return HVP_ERROR_BAD_MATRIX;
  }
  if (!hvp_elements_fit(matrix->value, (size_t)9 * matrix->blocks, matrix_bits(device))) {
    return HVP_ERROR_RANGE;
  }
  return HVP_OK;
}

hvp_status hvp_begin_load(struct hvp_device* device, struct hvp_load* load,
                          const struct hvp_matrix* matrix) {
  if (device == NULL || load == NULL || matrix == NULL || matrix->row_begin == NULL ||
      matrix->column == NULL || matrix->value == NULL) {
    return HVP_ERROR_ARGUMENT;
  }
  if (device->state != STATE_CONFIGURED && device->state != STATE_LOADED) return HVP_ERROR_STATE;
  const hvp_status status = check_matrix(device, matrix);
  if (status != HVP_OK) return status;

  device->state = STATE_CONFIGURED;
  device->nodes = matrix->nodes;
  *load = (struct hvp_load){.matrix = matrix};
  const int32_t size[2] = {(int32_t)matrix->nodes, (int32_t)matrix->blocks};
  hvp_write_elements(device, HVP_OFFSET(NODES), size, 2U, 32U);
  return HVP_OK;
}

hvp_status hvp_continue_load(struct hvp_device* device, struct hvp_load* load, bool* complete) {
  if (device == NULL || load == NULL || load->matrix == NULL || complete == NULL) {
    return HVP_ERROR_ARGUMENT;
  }
  if (device->state != STATE_CONFIGURED) return HVP_ERROR_STATE;
  const struct hvp_matrix* matrix = load->matrix;
  const struct {
    uint32_t offset;
    const int32_t* elements;
    size_t n;
    uint32_t bits;
  } arrays[] = {
      {HVP_OFFSET(ROW_BEGIN), matrix->row_begin, (size_t)matrix->nodes + 1U, 32U},
      {HVP_OFFSET(COLUMN), matrix->column, matrix->blocks, 32U},
      {HVP_OFFSET(VALUE), matrix->value, (size_t)9 * matrix->blocks, matrix_bits(device)},
  };
  const uint32_t count = (uint32_t)(sizeof(arrays) / sizeof(arrays[0]));
  if (load->array < count) {
    load->sent = hvp_write_burst(device, arrays[load->array].offset, arrays[load->array].elements,
                                 arrays[load->array].n, load->sent, arrays[load->array].bits);
    if (load->sent == arrays[load->array].n) {
      ++load->array;
      load->sent = 0U;
    }
  }
  *complete = load->array == count;
  const hvp_status status = hvp_bus_errors(device);
  if (status != HVP_OK) device->state = STATE_LOST;
  return status;
}

// What a board is left in whose check of a matrix ended so, before its answer is looked at.
static int state_after_check(hvp_status status, int interrupted) {
  switch (status) {
    case HVP_ERROR_INTERRUPTED:
      return interrupted;
    case HVP_ERROR_TIMEOUT:
    case HVP_ERROR_BUS:
    case HVP_ERROR_DATA:
      return STATE_LOST;
    default:
      return STATE_CONFIGURED;
  }
}

// Has the board check what was sent, and waits for it. In the state `interrupted` it does so
// already.
static hvp_status have_checked(struct hvp_device* device, uint32_t command, int interrupted,
                               uint64_t timeout_ns) {
  hvp_status status = HVP_OK;
  if (device->state != interrupted) {
    hvp_clear_done(device);
    hvp_write_register(device, HVP_OFFSET(CONTROL), command);
    // A board that has not heard of it would be waited for in vain.
    status = hvp_bus_errors(device);
  }
  if (status == HVP_OK) status = hvp_await_end(device, timeout_ns);
  device->state = state_after_check(status, interrupted);
  if (status != HVP_OK) return status;
  const bool loaded = (device->last_status & HVP__STATUS__MATRIX_LOADED_bm) != 0U;
  return loaded ? HVP_OK : HVP_ERROR_BOARD;
}

hvp_status hvp_end_load(struct hvp_device* device, const struct hvp_load* load) {
  if (device == NULL || load == NULL || load->matrix == NULL) return HVP_ERROR_ARGUMENT;
  if (device->state != STATE_CONFIGURED && device->state != STATE_CHECKING) return HVP_ERROR_STATE;
  hvp_status status =
      have_checked(device, HVP__CONTROL__LOAD_DONE_bm, STATE_CHECKING, HVP_LOAD_TIMEOUT_NS);
  if (status != HVP_OK) return status;
  device->blocks = load->matrix->blocks;
  device->bytes_of_values = 0U;
  if (device->uses_dma) {
    status = hvp_prepare_list(device);
    if (status != HVP_OK) return status;
  }
  device->state = STATE_LOADED;
  return HVP_OK;
}

hvp_status hvp_load_matrix(struct hvp_device* device, const struct hvp_matrix* matrix) {
  struct hvp_load load = {.matrix = matrix};
  if (device != NULL && device->state == STATE_CHECKING) return hvp_end_load(device, &load);
  hvp_status status = hvp_begin_load(device, &load, matrix);
  bool complete = false;
  while (status == HVP_OK && !complete) status = hvp_continue_load(device, &load, &complete);
  return status == HVP_OK ? hvp_end_load(device, &load) : status;
}

// By blocks, each of which the bus may have lost.
static hvp_status write_values(struct hvp_device* device, const int32_t* values, size_t n) {
  hvp_status status = HVP_OK;
  for (size_t sent = 0; sent < n && status == HVP_OK;) {
    sent = hvp_write_burst(device, HVP_OFFSET(VALUE), values, n, sent, matrix_bits(device));
    status = hvp_bus_errors(device);
  }
  if (status != HVP_OK) device->state = STATE_LOST;
  return status;
}

hvp_status hvp_update_values(struct hvp_device* device, const int32_t* values, size_t n,
                             uint64_t timeout_ns) {
  if (device == NULL || values == NULL) return HVP_ERROR_ARGUMENT;
  const bool fetched = device->uses_dma && device->bytes_of_values != 0U;
  if (device->state == STATE_LOADED) {
    if (n != (size_t)9 * device->blocks) return HVP_ERROR_ARGUMENT;
    if (device->minor_version < MINOR_VERSION_OF_VALUES) return HVP_ERROR_CAPABILITY;
    if (!hvp_elements_fit(values, n, matrix_bits(device))) return HVP_ERROR_RANGE;
    if (fetched) {
      hvp_fill_values(device, values);
    } else {
      const hvp_status status = write_values(device, values, n);
      if (status != HVP_OK) return status;
    }
  } else if (device->state != STATE_UPDATING) {
    return HVP_ERROR_STATE;
  }
  const uint32_t command = fetched ? HVP__CONTROL__FETCH_VALUES_bm : HVP__CONTROL__UPDATE_VALUES_bm;
  const hvp_status status = have_checked(device, command, STATE_UPDATING, timeout_ns);
  if (status == HVP_OK) device->state = STATE_LOADED;
  return status;
}

static hvp_status update_node(struct hvp_device* device, uint32_t node, uint32_t kind,
                              int32_t diagonal, uint32_t blocks) {
  uint32_t* words = device->scratch;
  words[0] = node;
  words[1] = kind;
  words[2] = (uint32_t)diagonal;
  words[3] = blocks;
  device->bus.write_block(device->bus.context, HVP_OFFSET(UPDATE_NODE), words, UPDATE_WORDS);
  hvp_write_register(device, HVP_OFFSET(CONTROL), HVP__CONTROL__UPDATE_NODE_bm);
  const hvp_status status = hvp_bus_errors(device);
  // Nobody knows what the board's matrix is now.
  if (status != HVP_OK) device->state = STATE_LOST;
  return status;
}

hvp_status hvp_constrain_node(struct hvp_device* device, uint32_t node, int32_t diagonal) {
  if (device == NULL || diagonal <= 0) return HVP_ERROR_ARGUMENT;
  if (device->state != STATE_LOADED) return HVP_ERROR_STATE;
  if (node >= device->nodes) return HVP_ERROR_BAD_NODE;
  if (!hvp_elements_fit(&diagonal, 1U, matrix_bits(device))) return HVP_ERROR_RANGE;
  return update_node(device, node, HVP_UPDATE_KIND_CONSTRAIN, diagonal, 0U);
}

hvp_status hvp_restore_node(struct hvp_device* device, uint32_t node, const int32_t* values,
                            uint32_t blocks) {
  if (device == NULL || values == NULL) return HVP_ERROR_ARGUMENT;
  if (device->state != STATE_LOADED) return HVP_ERROR_STATE;
  if (node >= device->nodes) return HVP_ERROR_BAD_NODE;
  if (!hvp_between(blocks, 1U, device->capability.max_row_blocks)) return HVP_ERROR_BAD_ROW;
  const size_t n = (size_t)9 * blocks;
  if (!hvp_elements_fit(values, n, matrix_bits(device))) return HVP_ERROR_RANGE;
  hvp_write_elements(device, HVP_OFFSET(ROW), values, n, matrix_bits(device));
  return update_node(device, node, HVP_UPDATE_KIND_ROW, 1, blocks);
}
