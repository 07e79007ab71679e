// A driver's first solve, on a board that is not there yet (docs/first-driver.md).
#include <stdio.h>

#include "app/board/hvp_board.h"

// K = diag(64, 32, 16) on one node, in the words of the board.
static const int32_t kRowBegin[] = {0, 1};
static const int32_t kColumn[] = {0};
static const int32_t kValue[] = {64, 0, 0, 0, 32, 0, 0, 0, 16};

int main(int argc, char** argv) {
  char why[256] = "usage: solve SCENARIO.toml [RECORD]";
  const struct hvp_board_options options = {.record = argc == 3 ? argv[2] : NULL};
  struct hvp_board* board =
      argc == 2 || argc == 3 ? hvp_board_open(argv[1], &options, why, sizeof why) : NULL;
  if (board == NULL) return fprintf(stderr, "%s\n", why), 2;

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
  if (status == HVP_OK) status = hvp_solve(&device, b, u, 3, 1000000);
  printf("%s: U = %d %d %d", hvp_status_text(status), u[0], u[1], u[2]);

  struct hvp_board_job job;
  if (hvp_board_last_job(board, &job)) {
    printf(" in %.3f us, of which bus %.3f, board %.3f", 1e-6 * (double)(job.end_ps - job.begin_ps),
           1e-6 * (double)job.bus_ps, 1e-6 * (double)job.fpga_ps);
  }
  printf("\n");
  hvp_board_close(board);
  return status == HVP_OK ? 0 : 1;
}
