#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/board/hvp_board.h"
#include "driver/linux/guest/servo_frames.h"
#include "driver/user/hvp_client.h"

// The frames that hvp-servo makes in a guest, made in the board's own process:
//   servo_in_process SCENARIO FRAMES OUT
// The driver, the board and the frames are the same; only who calls is another one. Times are left
// out, as this host takes none.

static int fail(const char* what, hvp_status status) {
  (void)fprintf(stderr, "servo_in_process: %s: %s\n", what, hvp_status_text(status));
  return 1;
}

static hvp_status make_frame(struct hvp_client* client, struct servo_frames* frames, int32_t* u) {
  const size_t n = (size_t)3 * frames->matrix.nodes;
  hvp_status status = HVP_OK;
  for (uint32_t left = servo_take_updates(frames); left > 0U; --left) {
    const struct servo_update change = servo_take_update(frames);
    if (status != HVP_OK) continue;
    status = change.kind == SERVO_CONSTRAIN
                 ? hvp_client_constrain_node(client, change.node, change.diagonal)
                 : hvp_client_restore_node(client, change.node, change.values, change.blocks);
  }
  const int32_t* b = servo_take_rhs(frames);
  if (status == HVP_OK) status = hvp_client_write_rhs(client, b, n);
  if (status == HVP_OK) status = hvp_client_start(client);
  if (status == HVP_OK) status = hvp_client_wait(client, 1000000000U);
  if (status == HVP_OK) status = hvp_client_read_solution(client, u, n);
  return status;
}

static int run(struct hvp_client* client, struct servo_frames* frames, int32_t* u, FILE* out) {
  hvp_status status = hvp_client_configure(client, &frames->config);
  if (status == HVP_OK) status = hvp_client_load_matrix(client, &frames->matrix);
  if (status != HVP_OK) return fail("set-up", status);
  bool written = servo_write_head(out, frames);
  for (uint32_t k = 0; k < frames->frames; ++k) {
    status = make_frame(client, frames, u);
    if (status != HVP_OK) return fail("a frame", status);
    const struct servo_record record = {.flags = hvp_client_last_flags(client)};
    written = written && servo_write_frame(out, &record, u, (size_t)3 * frames->matrix.nodes);
  }
  return written ? 0 : 3;
}

int main(int argc, char** argv) {
  struct servo_frames frames;
  char why[512];
  if (argc != 4 || !servo_open_frames(&frames, argv[2])) return 2;
  struct hvp_board* board = hvp_board_open(argv[1], NULL, why, sizeof why);
  if (board == NULL) {
    (void)fprintf(stderr, "servo_in_process: %s\n", why);
    return 2;
  }
  struct hvp_client* client = NULL;
  const hvp_status status = hvp_client_open_bus(&client, hvp_board_bus(board));
  if (status != HVP_OK) return fail(argv[1], status);
  int32_t* u = calloc((size_t)3 * frames.matrix.nodes + 1U, sizeof *u);
  FILE* out = fopen(argv[3], "wb");
  int ended = 3;
  if (u != NULL && out != NULL) ended = run(client, &frames, u, out);
  if (out != NULL && fclose(out) != 0) ended = 3;
  free(u);
  (void)hvp_client_close(client);
  hvp_board_close(board);
  servo_close_frames(&frames);
  return ended;
}
