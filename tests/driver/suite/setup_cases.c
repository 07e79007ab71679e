#include "tests/driver/suite/case.h"

// Open, settings and the matrix.

static void opens(struct suite_case* c) {
  const struct hvp_capability* capability = hvp_client_capability(c->client);
  EXPECT(c, capability != NULL);
  EXPECT(c, capability->max_nodes >= NODES);
  EXPECT(c, capability->max_blocks >= BLOCKS);
  EXPECT(c, capability->max_row_blocks >= 3U);
  EXPECT(c, capability->max_matrix_bits >= 12U && capability->max_vector_bits >= 16U);
  EXPECT(c, capability->clock_khz > 0U);
  EXPECT(c, (capability->methods & 1U << HVP_METHOD_CG) != 0U);
  EXPECT(c, hvp_client_info_of(c->client) != NULL);
}

static void opens_again(struct suite_case* c) {
  for (int i = 0; i < 3; ++i) {
    EXPECT_OK(c, hvp_client_close(c->client));
    c->client = NULL;
    EXPECT_OK(c, c->board->open(c->board->context, &c->client));
  }
}

static void order_of_calls(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  struct hvp_result result;
  problem_make(&p);
  const struct hvp_matrix matrix = problem_matrix(&p);
  // Before the settings.
  EXPECT_STATUS(c, hvp_client_load_matrix(c->client, &matrix), HVP_ERROR_STATE);
  EXPECT_STATUS(c, hvp_client_start(c->client), HVP_ERROR_STATE);
  EXPECT_STATUS(c, hvp_client_wait(c->client, 1000), HVP_ERROR_STATE);
  const struct hvp_solver_config config = problem_config();
  EXPECT_OK(c, hvp_client_configure(c->client, &config));
  // Before the matrix.
  EXPECT_STATUS(c, hvp_client_write_rhs(c->client, p.b, UNKNOWNS), HVP_ERROR_STATE);
  EXPECT_STATUS(c, hvp_client_constrain_node(c->client, 1U, 1), HVP_ERROR_STATE);
  EXPECT_STATUS(c, hvp_client_solve(c->client, p.b, u, UNKNOWNS, LONG_NS), HVP_ERROR_STATE);
  EXPECT_OK(c, hvp_client_load_matrix(c->client, &matrix));
  // Before a job, and while it runs.
  EXPECT_STATUS(c, hvp_client_read_result(c->client, &result), HVP_ERROR_STATE);
  EXPECT_STATUS(c, hvp_client_wait(c->client, 1000), HVP_ERROR_STATE);
  EXPECT_OK(c, hvp_client_start(c->client));
  EXPECT_STATUS(c, hvp_client_start(c->client), HVP_ERROR_STATE);
  EXPECT_STATUS(c, hvp_client_read_solution(c->client, u, UNKNOWNS), HVP_ERROR_STATE);
  EXPECT_STATUS(c, hvp_client_configure(c->client, &config), HVP_ERROR_STATE);
  EXPECT_OK(c, hvp_client_wait(c->client, LONG_NS));
}

static void wrong_arguments(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  problem_make(&p);
  EXPECT_STATUS(c, hvp_client_configure(c->client, NULL), HVP_ERROR_ARGUMENT);
  EXPECT_STATUS(c, hvp_client_load_matrix(c->client, NULL), HVP_ERROR_ARGUMENT);
  if (!case_load(c, &p)) return;
  EXPECT_STATUS(c, hvp_client_write_rhs(c->client, NULL, UNKNOWNS), HVP_ERROR_ARGUMENT);
  EXPECT_STATUS(c, hvp_client_write_rhs(c->client, p.b, UNKNOWNS - 1), HVP_ERROR_ARGUMENT);
  EXPECT_STATUS(c, hvp_client_read_solution(c->client, u, 0U), HVP_ERROR_ARGUMENT);
  EXPECT_STATUS(c, hvp_client_solve(c->client, p.b, NULL, UNKNOWNS, LONG_NS), HVP_ERROR_ARGUMENT);
  EXPECT_STATUS(c, hvp_client_constrain_node(c->client, 1U, 0), HVP_ERROR_ARGUMENT);
  EXPECT_STATUS(c, hvp_client_restore_node(c->client, 1U, NULL, 3U), HVP_ERROR_ARGUMENT);
  (void)case_solve(c, &p, u);
}

static void settings_that_no_board_has(struct suite_case* c) {
  struct hvp_solver_config config = problem_config();
  config.method = HVP_METHOD_COUNT;
  EXPECT_STATUS(c, hvp_client_configure(c->client, &config), HVP_ERROR_ARGUMENT);
  config = problem_config();
  config.iterations = 0U;
  EXPECT_STATUS(c, hvp_client_configure(c->client, &config), HVP_ERROR_ARGUMENT);
  config = problem_config();
  config.stop_residual = ~(uint64_t)0;
  EXPECT_STATUS(c, hvp_client_configure(c->client, &config), HVP_ERROR_ARGUMENT);
  config = problem_config();
  config.vector_bits = 33U;
  EXPECT_STATUS(c, hvp_client_configure(c->client, &config), HVP_ERROR_CAPABILITY);
}

static void matrices_that_are_wrong(struct suite_case* c) {
  struct problem p;
  problem_make(&p);
  struct hvp_matrix matrix = problem_matrix(&p);
  if (!case_load(c, &p)) return;
  matrix.nodes = 0U;
  EXPECT_STATUS(c, hvp_client_load_matrix(c->client, &matrix), HVP_ERROR_BAD_SIZE);
  matrix = problem_matrix(&p);
  matrix.blocks = BLOCKS - 1U;
  EXPECT_STATUS(c, hvp_client_load_matrix(c->client, &matrix), HVP_ERROR_BAD_MATRIX);
  p.column[1] = p.column[0];
  matrix = problem_matrix(&p);
  EXPECT_STATUS(c, hvp_client_load_matrix(c->client, &matrix), HVP_ERROR_BAD_MATRIX);
  problem_make(&p);
  p.value[4] = 2048;
  EXPECT_STATUS(c, hvp_client_load_matrix(c->client, &matrix), HVP_ERROR_RANGE);
  // What is refused is not sent: the matrix on the board is as it was.
  int32_t u[UNKNOWNS];
  problem_make(&p);
  (void)case_solve(c, &p, u);
}

static void loads_again(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  problem_make(&p);
  for (int i = 0; i < 3; ++i) {
    if (!case_load(c, &p) || !case_solve(c, &p, u)) return;
    problem_constrain(&p, (uint32_t)i, 1000);
  }
}

static void reset_forgets(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  problem_make(&p);
  if (!case_load(c, &p)) return;
  EXPECT_OK(c, hvp_client_reset(c->client));
  EXPECT_STATUS(c, hvp_client_start(c->client), HVP_ERROR_STATE);
  if (!case_load(c, &p)) return;
  (void)case_solve(c, &p, u);
}

const struct case_entry setup_cases[] = {
    {"open", opens},
    {"open-again", opens_again},
    {"order-of-calls", order_of_calls},
    {"wrong-arguments", wrong_arguments},
    {"wrong-settings", settings_that_no_board_has},
    {"load-wrong-matrices", matrices_that_are_wrong},
    {"load-again", loads_again},
    {"reset-forgets", reset_forgets},
    {NULL, NULL},
};
