// A test that breaks the board where it wants to, and says where it stopped (docs/faults.md).
#include <stdio.h>
#include <string.h>

#include "app/board/hvp_board.h"

// K = diag(64, 32, 16) on one node, in the words of the board.
static const int32_t kRowBegin[] = {0, 1};
static const int32_t kColumn[] = {0};
static const int32_t kValue[] = {64, 0, 0, 0, 32, 0, 0, 0, 16};

// At this point of simulated time, before the access that it is.
static void stopped(void* context, const struct hvp_board_stop* stop) {
  char why[256];
  printf("%s\n", stop->what);
  if (strcmp(stop->point, "job 1") != 0) return;
  if (!hvp_board_inject(context, "kind=lost-interrupt", why, sizeof why)) printf("%s\n", why);
}

int main(int argc, char** argv) {
  char why[256] = "usage: trouble SCENARIO.toml";
  struct hvp_board* board = argc == 2 ? hvp_board_open(argv[1], NULL, why, sizeof why) : NULL;
  if (board == NULL || !hvp_board_stop_at(board, "job 1", stopped, board, why, sizeof why) ||
      !hvp_board_stop_at(board, "write to CONTROL", stopped, board, why, sizeof why)) {
    return fprintf(stderr, "%s\n", why), 2;
  }
  struct hvp_device device;
  uint32_t scratch[16];
  int32_t b[] = {640, 640, 640}, u[3];
  const struct hvp_matrix k = {1, 1, kRowBegin, kColumn, kValue};
  const struct hvp_solver_config config = {.method = HVP_METHOD_JACOBI_PCG,
                                           .iterations = 4,
                                           .matrix_bits = 12,
                                           .vector_bits = 16,
                                           .coefficient_bits = 16,
                                           .dynamic_scaling = true};
  hvp_status status = hvp_open(&device, hvp_board_bus(board), scratch, 16);
  if (status == HVP_OK) status = hvp_configure(&device, &config);
  if (status == HVP_OK) status = hvp_load_matrix(&device, &k);
  for (int n = 0; n < 3 && status == HVP_OK; ++n) {
    struct hvp_board_job job;
    status = hvp_solve(&device, b, u, 3, 1000000);
    if (hvp_board_last_job(board, &job)) {
      printf("job %d: %s in %.3f us\n", n, hvp_status_name(job.status),
             1e-6 * (double)(job.end_ps - job.begin_ps));
    }
  }
  hvp_board_close(board);
  return status == HVP_OK ? 0 : 1;
}
