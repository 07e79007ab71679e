#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/board/hvp_board.h"
#include "driver/linux/guest/servo_frames.h"
#include "driver/user/hvp_client.h"

// The frames that hvp-servo makes in a guest, made in the board's own process:
//   servo_in_process SCENARIO FRAMES OUT [--records]
// The driver, the board and the frames are the same; only who calls is another one. Times are left
// out, as this host takes none. With --records it prints that of each job: number, status,
// nanoseconds.

// As hvp-servo's --timeout-ms 20.
#define TIMEOUT_NS ((uint64_t)20000000)

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
  if (status == HVP_OK) status = hvp_client_wait(client, TIMEOUT_NS);
  if (status == HVP_OK) status = hvp_client_read_solution(client, u, n);
  return status;
}

// Memory for the board's engine, as the module makes it; where the board has none, b and U go in
// blocks.
static hvp_status use_dma(struct hvp_board* board, struct hvp_client* client) {
  enum { LIST_WORDS = 64, VECTOR_WORDS = 4096 };
  static _Alignas(64) uint32_t memory[LIST_WORDS + 2 * VECTOR_WORDS];
  static const uint64_t address = 0x10000000U;
  if (!hvp_board_map(board, address, memory, sizeof memory)) return HVP_OK;
  const uint64_t vectors = address + LIST_WORDS * sizeof *memory;
  const uint32_t bytes = VECTOR_WORDS * (uint32_t)sizeof *memory;
  static struct hvp_segment to_board;
  static struct hvp_segment to_host;
  to_board = (struct hvp_segment){memory + LIST_WORDS, vectors, bytes};
  to_host = (struct hvp_segment){memory + LIST_WORDS + VECTOR_WORDS, vectors + bytes, bytes};
  const struct hvp_dma dma = {.to_board = &to_board,
                              .to_board_count = 1,
                              .to_host = &to_host,
                              .to_host_count = 1,
                              .list = memory,
                              .list_address = address,
                              .record = memory + LIST_WORDS / 2,
                              .record_address = address + LIST_WORDS / 2 * sizeof *memory};
  const hvp_status status = hvp_client_use_dma(client, &dma);
  return status == HVP_ERROR_CAPABILITY ? HVP_OK : status;
}

// For print_record() alone.
static bool prints_records;

static void print_record(struct hvp_board* board) {
  struct hvp_board_job job;
  if (!prints_records || !hvp_board_last_job(board, &job)) return;
  (void)printf("%u %s %u\n", (unsigned)job.number, hvp_status_name(job.status),
               (unsigned)((job.end_ps - job.begin_ps) / 1000U));
}

static int run(struct hvp_board* board, struct hvp_client* client, struct servo_frames* frames,
               int32_t* u, FILE* out) {
  hvp_status status = hvp_client_configure(client, &frames->config);
  if (status == HVP_OK) status = hvp_client_load_matrix(client, &frames->matrix);
  if (status != HVP_OK) return fail("set-up", status);
  bool written = servo_write_head(out, frames);
  for (uint32_t k = 0; k < frames->frames; ++k) {
    status = make_frame(client, frames, u);
    if (status != HVP_OK) {
      // A job without an end is one that failed when the board forgets it.
      (void)hvp_client_reset(client);
      print_record(board);
      return fail("a frame", status);
    }
    print_record(board);
    const struct servo_record record = {.flags = hvp_client_last_flags(client)};
    written = written && servo_write_frame(out, &record, u, (size_t)3 * frames->matrix.nodes);
  }
  return written ? 0 : 3;
}

int main(int argc, char** argv) {
  struct servo_frames frames;
  char why[512];
  prints_records = argc == 5 && strcmp(argv[4], "--records") == 0;
  if ((argc != 4 && !prints_records) || !servo_open_frames(&frames, argv[2])) return 2;
  struct hvp_board* board = hvp_board_open(argv[1], NULL, why, sizeof why);
  if (board == NULL) {
    (void)fprintf(stderr, "servo_in_process: %s\n", why);
    return 2;
  }
  struct hvp_client* client = NULL;
  hvp_status status = hvp_client_open_bus(&client, hvp_board_bus(board));
  if (status == HVP_OK) status = use_dma(board, client);
  if (status != HVP_OK) return fail(argv[1], status);
  int32_t* u = calloc((size_t)3 * frames.matrix.nodes + 1U, sizeof *u);
  FILE* out = fopen(argv[3], "wb");
  int ended = 3;
  if (u != NULL && out != NULL) ended = run(board, client, &frames, u, out);
  if (out != NULL && fclose(out) != 0) ended = 3;
  free(u);
  (void)hvp_client_close(client);
  hvp_board_close(board);
  servo_close_frames(&frames);
  return ended;
}
