// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#include <errno.h>
#include <stdlib.h>

#include "driver/generated/hvp_registers.h"
#include "driver/user/client.h"
#include "driver/user/vfio_user_client.h"

// The driver in the program, over the socket of `hvp serve`. Where the board has an engine, b, U
// and new values go through memory that the program shares with it.

// Bus addresses and bytes of that memory: b, U and the values of the largest matrix that a board
// holds, and a page each for the list, the record and the list of values.
enum {
  VECTOR_BYTES = 3 * 8192 * 4,
  VALUES_BYTES = sizeof(hvp__VALUE_t),
  PAGE_BYTES = 4096,
  LIST_AT = 2 * VECTOR_BYTES,
  RECORD_AT = LIST_AT + PAGE_BYTES,
  VALUES_LIST_AT = RECORD_AT + PAGE_BYTES,
  VALUES_AT = VALUES_LIST_AT + PAGE_BYTES,
  AREA_BYTES = VALUES_AT + VALUES_BYTES
};
#define AREA_ADDRESS ((uint64_t)0x40000000)

struct socket_board {
  struct hvp_vfio_user way;
  void* area;  // null: none
  struct hvp_segment to_board;
  struct hvp_segment to_host;
  struct hvp_segment values;
};

static void leave(void* context) {
  struct socket_board* board = context;
  if (board->area != NULL) {
    (void)hvp_vfio_user_unshare(&board->way, AREA_ADDRESS, AREA_BYTES, board->area);
  }
  hvp_vfio_user_close(&board->way);
  free(board);
}

// From a byte of the area on.
static struct hvp_segment part(const struct socket_board* board, size_t at, uint32_t bytes) {
  return (struct hvp_segment){
      .memory = (uint32_t*)board->area + at / sizeof(uint32_t),
      .bus_address = AREA_ADDRESS + at,
      .bytes = bytes,
  };
}

static hvp_status share_memory(struct socket_board* board, struct hvp_client* client) {
  const int status = hvp_vfio_user_share(&board->way, AREA_ADDRESS, AREA_BYTES, &board->area);
  if (status != 0) return client_failed(HVP_ERROR_BUS, -status);
  board->to_board = part(board, 0U, VECTOR_BYTES);
  board->to_host = part(board, VECTOR_BYTES, VECTOR_BYTES);
  board->values = part(board, VALUES_AT, VALUES_BYTES);
  const struct hvp_segment list = part(board, LIST_AT, PAGE_BYTES);
  const struct hvp_segment record = part(board, RECORD_AT, PAGE_BYTES);
  const struct hvp_segment values_list = part(board, VALUES_LIST_AT, PAGE_BYTES);
  const struct hvp_dma dma = {.to_board = &board->to_board,
                              .to_board_count = 1U,
                              .to_host = &board->to_host,
                              .to_host_count = 1U,
                              .list = list.memory,
                              .list_address = list.bus_address,
                              .record = record.memory,
                              .record_address = record.bus_address,
                              .values = &board->values,
                              .values_count = 1U,
                              .values_list = values_list.memory,
                              .values_list_address = values_list.bus_address};
  const hvp_status used = hvp_client_use_dma(client, &dma);
  return used == HVP_ERROR_CAPABILITY ? HVP_OK : used;
}

hvp_status client_open_vfio_user(struct hvp_client** client, const char* path) {
  struct socket_board* board = calloc(1U, sizeof *board);
  if (board == NULL) return client_failed(HVP_ERROR_ARGUMENT, ENOMEM);
  const int error = hvp_vfio_user_open(&board->way, path);
  if (error != 0) {
    free(board);
    return client_failed(error == -EBUSY ? HVP_ERROR_STATE : HVP_ERROR_NO_DEVICE, -error);
  }
  const struct hvp_bus bus = hvp_vfio_user_bus(&board->way);
  hvp_status status = hvp_client_open_bus(client, &bus);
  if (status == HVP_OK) {
    status = share_memory(board, *client);
    hvp_client_at_close(*client, leave, board);
    if (status != HVP_OK) {
      const int why = errno;
      (void)hvp_client_close(*client);
      *client = NULL;
      errno = why;
    }
    return status;
  }
  const int why = errno;
  leave(board);
  errno = why;
  return status;
}
