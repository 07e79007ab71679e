#include "driver/hvp_device.h"

static_assert(offsetof(hvp_t, BLOCKS) - offsetof(hvp_t, NODES) == 4, "one burst writes both");

enum { UPDATE_WORDS = 4 };
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

hvp_status hvp_load_matrix(struct hvp_device* device, const struct hvp_matrix* matrix) {
  if (device == NULL || matrix == NULL || matrix->row_begin == NULL || matrix->column == NULL ||
      matrix->value == NULL) {
    return HVP_ERROR_ARGUMENT;
  }
  if (device->state != STATE_CONFIGURED && device->state != STATE_LOADED) return HVP_ERROR_STATE;
  hvp_status status = check_matrix(device, matrix);
  if (status != HVP_OK) return status;

  device->state = STATE_CONFIGURED;
  const int32_t size[2] = {(int32_t)matrix->nodes, (int32_t)matrix->blocks};
  hvp_write_elements(device, HVP_OFFSET(NODES), size, 2U, 32U);
  hvp_write_elements(device, HVP_OFFSET(ROW_BEGIN), matrix->row_begin, matrix->nodes + 1U, 32U);
  hvp_write_elements(device, HVP_OFFSET(COLUMN), matrix->column, matrix->blocks, 32U);
  hvp_write_elements(device, HVP_OFFSET(VALUE), matrix->value, (size_t)9 * matrix->blocks,
                     matrix_bits(device));
  hvp_clear_done(device);
  hvp_write_register(device, HVP_OFFSET(CONTROL), HVP__CONTROL__LOAD_DONE_bm);
  status = hvp_await_end(device, HVP_LOAD_TIMEOUT_NS);
  if (status == HVP_ERROR_TIMEOUT || status == HVP_ERROR_BUS) device->state = STATE_LOST;
  if (status != HVP_OK) return status;
  if ((device->last_status & HVP__STATUS__MATRIX_LOADED_bm) == 0U) return HVP_ERROR_BOARD;
  device->nodes = matrix->nodes;
  if (device->uses_dma) {
    status = hvp_prepare_list(device);
    if (status != HVP_OK) return status;
  }
  device->state = STATE_LOADED;
  return HVP_OK;
}

static void update_node(struct hvp_device* device, uint32_t node, uint32_t kind, int32_t diagonal,
                        uint32_t blocks) {
  uint32_t* words = device->scratch;
  words[0] = node;
  words[1] = kind;
  words[2] = (uint32_t)diagonal;
  words[3] = blocks;
  device->bus.write_block(device->bus.context, HVP_OFFSET(UPDATE_NODE), words, UPDATE_WORDS);
  hvp_write_register(device, HVP_OFFSET(CONTROL), HVP__CONTROL__UPDATE_NODE_bm);
}

hvp_status hvp_constrain_node(struct hvp_device* device, uint32_t node, int32_t diagonal) {
  if (device == NULL || diagonal <= 0) return HVP_ERROR_ARGUMENT;
  if (device->state != STATE_LOADED) return HVP_ERROR_STATE;
  if (node >= device->nodes) return HVP_ERROR_BAD_NODE;
  if (!hvp_elements_fit(&diagonal, 1U, matrix_bits(device))) return HVP_ERROR_RANGE;
  update_node(device, node, HVP_UPDATE_KIND_CONSTRAIN, diagonal, 0U);
  return HVP_OK;
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
  update_node(device, node, HVP_UPDATE_KIND_ROW, 1, blocks);
  return HVP_OK;
}
