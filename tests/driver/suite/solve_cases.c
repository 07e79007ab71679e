#include <string.h>

#include "driver/generated/hvp_registers.h"
#include "tests/driver/suite/case.h"

// Jobs that end well, and updates of the matrix in between.

static void solves(struct suite_case* c) {
  struct problem p;
  int32_t first[UNKNOWNS];
  int32_t again[UNKNOWNS];
  problem_make(&p);
  if (!case_load(c, &p) || !case_solve(c, &p, first)) return;
  // From zero, so that the words are the same.
  if (!case_solve(c, &p, again)) return;
  EXPECT(c, memcmp(first, again, sizeof first) == 0);
}

// K is 2^SHIFT times the identity in effect: U is b, to the word.
static void solves_the_identity(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  problem_make(&p);
  for (uint32_t node = 0; node < NODES; ++node) problem_constrain(&p, node, 1 << (SHIFT - 1));
  if (!case_load(c, &p) || !case_solve(c, &p, u)) return;
  for (int i = 0; i < UNKNOWNS; ++i) EXPECT(c, u[i] == 2 * p.b[i]);
}

static void step_by_step(struct suite_case* c) {
  struct problem p;
  int32_t whole[UNKNOWNS];
  int32_t u[UNKNOWNS];
  problem_make(&p);
  if (!case_load(c, &p) || !case_solve(c, &p, whole)) return;
  EXPECT_OK(c, hvp_client_write_rhs(c->client, p.b, UNKNOWNS));
  EXPECT_OK(c, hvp_client_start(c->client));
  EXPECT_OK(c, hvp_client_wait(c->client, LONG_NS));
  EXPECT_OK(c, hvp_client_read_solution(c->client, u, UNKNOWNS));
  EXPECT(c, memcmp(u, whole, sizeof u) == 0);
  // The board has b and starts from zero: nothing but the job is new.
  EXPECT_OK(c, hvp_client_start(c->client));
  EXPECT_OK(c, hvp_client_wait(c->client, LONG_NS));
  EXPECT_OK(c, hvp_client_read_solution(c->client, u, UNKNOWNS));
  EXPECT(c, memcmp(u, whole, sizeof u) == 0);
}

static void says_what_a_job_was(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  struct hvp_result result;
  problem_make(&p);
  if (!case_load(c, &p)) return;
  for (uint32_t job = 1; job <= 3U; ++job) {
    if (!case_solve(c, &p, u)) return;
    EXPECT_OK(c, hvp_client_read_result(c->client, &result));
    EXPECT(c, result.job == job);
    EXPECT(c, result.iterations > 0U && result.iterations <= problem_config().iterations);
    EXPECT(c, result.cycles > 0U);
    EXPECT(c, result.saturations == 0U && result.wraps == 0U);
  }
}

static void starts_from_a_guess(struct suite_case* c) {
  struct problem p;
  int32_t solution[UNKNOWNS];
  int32_t u[UNKNOWNS];
  problem_make(&p);
  if (!case_load(c, &p) || !case_solve(c, &p, solution)) return;
  struct hvp_solver_config config = problem_config();
  config.start = HVP_START_FROM_LAST;
  config.iterations = 1U;
  EXPECT_OK(c, hvp_client_configure(c->client, &config));
  const int32_t zero[UNKNOWNS] = {0};
  EXPECT_OK(c, hvp_client_write_initial_guess(c->client, zero, UNKNOWNS));
  EXPECT_OK(c, hvp_client_solve(c->client, p.b, u, UNKNOWNS, LONG_NS));
  const int32_t from_zero = problem_residual(&p, u);
  EXPECT_OK(c, hvp_client_write_initial_guess(c->client, solution, UNKNOWNS));
  EXPECT_OK(c, hvp_client_solve(c->client, p.b, u, UNKNOWNS, LONG_NS));
  EXPECT(c, problem_residual(&p, u) < from_zero);
  case_hash(c, u, UNKNOWNS);
}

static void stops_at_a_residual(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  struct hvp_result result;
  problem_make(&p);
  if (!case_load(c, &p)) return;
  struct hvp_solver_config config = problem_config();
  const double residual = 0.25;
  memcpy(&config.stop_residual, &residual, sizeof residual);
  EXPECT_OK(c, hvp_client_configure(c->client, &config));
  EXPECT_OK(c, hvp_client_solve(c->client, p.b, u, UNKNOWNS, LONG_NS));
  EXPECT_OK(c, hvp_client_read_result(c->client, &result));
  EXPECT(c, result.reached);
  EXPECT(c, result.iterations < problem_config().iterations);
  case_hash(c, u, UNKNOWNS);
}

static void changes_nodes(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  problem_make(&p);
  if (!case_load(c, &p)) return;
  enum { NODE = 5 };  // has two neighbours
  struct problem held = p;
  problem_constrain(&held, NODE, 1000);
  EXPECT_OK(c, hvp_client_constrain_node(c->client, NODE, 1000));
  if (!case_solve(c, &held, u)) return;
  EXPECT_OK(c, hvp_client_restore_node(c->client, NODE, &p.value[9 * p.row_begin[NODE]], 3U));
  (void)case_solve(c, &p, u);
}

void case_update_values(struct suite_case* c) {
  struct problem p;
  struct problem held;
  int32_t u[UNKNOWNS];
  int32_t again[UNKNOWNS];
  enum { NODE = 5, VALUES = 9 * BLOCKS };
  problem_make(&p);
  EXPECT_STATUS(c, hvp_client_update_values(c->client, p.value, VALUES, LONG_NS), HVP_ERROR_STATE);
  if (!case_load(c, &p) || !case_solve(c, &p, u)) return;
  problem_change(&p);
  EXPECT_OK(c, hvp_client_update_values(c->client, p.value, VALUES, LONG_NS));
  if (!case_solve(c, &p, u)) return;
  // The words of a board that was loaded with them.
  if (!case_load(c, &p) || !case_solve(c, &p, again)) return;
  EXPECT(c, memcmp(u, again, sizeof u) == 0);
  // A node that is held stays so until it gets its row of the new matrix.
  EXPECT_OK(c, hvp_client_constrain_node(c->client, NODE, 1000));
  problem_change(&p);
  EXPECT_OK(c, hvp_client_update_values(c->client, p.value, VALUES, LONG_NS));
  held = p;
  problem_constrain(&held, NODE, 1000);
  if (!case_solve(c, &held, u)) return;
  EXPECT_OK(c, hvp_client_restore_node(c->client, NODE, &p.value[9 * p.row_begin[NODE]], 3U));
  if (!case_solve(c, &p, u)) return;
  // What cannot be is not sent.
  EXPECT_STATUS(c, hvp_client_update_values(c->client, p.value, VALUES - 1, LONG_NS),
                HVP_ERROR_ARGUMENT);
  EXPECT_STATUS(c, hvp_client_update_values(c->client, NULL, VALUES, LONG_NS), HVP_ERROR_ARGUMENT);
  held = p;
  held.value[0] = 2048;
  EXPECT_STATUS(c, hvp_client_update_values(c->client, held.value, VALUES, LONG_NS),
                HVP_ERROR_RANGE);
  (void)case_solve(c, &p, u);
}

static void every_method(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  problem_make(&p);
  const struct hvp_matrix matrix = problem_matrix(&p);
  for (uint32_t method = 0; method < HVP_METHOD_COUNT; ++method) {
    if ((hvp_client_capability(c->client)->methods >> method & 1U) == 0U) continue;
    struct hvp_solver_config config = problem_config();
    config.method = (hvp_method)method;
    // Those that carry A·d along drift: r anew now and then.
    if (method == HVP_METHOD_CHRONOPOULOS_GEAR || method == HVP_METHOD_PIPELINED_CG) {
      config.replace_every = 10U;
    }
    const bool preconditioned =
        method == HVP_METHOD_JACOBI_PCG || method == HVP_METHOD_BLOCK_JACOBI_PCG;
    EXPECT_OK(c, hvp_client_configure(c->client, &config));
    EXPECT_OK(c, hvp_client_load_matrix(c->client, &matrix));
    if (preconditioned) {
      // Without the static scale: K·U is b itself.
      struct problem scaled = p;
      for (int i = 0; i < UNKNOWNS; ++i) scaled.b[i] = p.b[i] * (1 << SHIFT);
      EXPECT_OK(c, hvp_client_solve(c->client, scaled.b, u, UNKNOWNS, LONG_NS));
      EXPECT(c, problem_residual(&p, u) <= 4);
    } else if (!case_solve(c, &p, u)) {
      return;
    }
    case_hash(c, u, UNKNOWNS);
  }
}

static void other_words(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  problem_make(&p);
  const struct hvp_matrix matrix = problem_matrix(&p);
  static const struct {
    uint32_t matrix_bits, vector_bits;
    bool one_a_word;
  } words[] = {{12, 16, true}, {16, 24, false}, {24, 32, false}};
  for (size_t i = 0; i < sizeof words / sizeof words[0]; ++i) {
    struct hvp_solver_config config = problem_config();
    config.matrix_bits = words[i].matrix_bits;
    config.vector_bits = words[i].vector_bits;
    config.one_a_word = words[i].one_a_word;
    const struct hvp_capability* capability = hvp_client_capability(c->client);
    if (config.matrix_bits > capability->max_matrix_bits ||
        config.vector_bits > capability->max_vector_bits) {
      continue;
    }
    EXPECT_OK(c, hvp_client_configure(c->client, &config));
    EXPECT_OK(c, hvp_client_load_matrix(c->client, &matrix));
    if (c->board->peek != NULL) {
      const uint32_t packing =
          c->board->peek(c->board->context, (uint32_t)offsetof(hvp_t, PACKING));
      EXPECT(c, (packing != 0U) == words[i].one_a_word);
    }
    if (!case_solve(c, &p, u)) return;
  }
}

static void saturation_is_said(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  struct hvp_result result;
  problem_make(&p);
  // U would have to be far beyond its words.
  for (int i = 0; i < UNKNOWNS; ++i) p.b[i] = i % 2 == 0 ? 32767 : -32768;
  for (uint32_t node = 0; node < NODES; ++node) problem_constrain(&p, node, 1);
  if (!case_load(c, &p)) return;
  EXPECT_OK(c, hvp_client_solve(c->client, p.b, u, UNKNOWNS, LONG_NS));
  EXPECT_OK(c, hvp_client_read_result(c->client, &result));
  EXPECT(c, result.saturations > 0U);
  EXPECT(c, (hvp_client_last_flags(c->client) & 1U) != 0U);
  struct hvp_solver_config config = problem_config();
  config.reject_saturated = true;
  EXPECT_OK(c, hvp_client_configure(c->client, &config));
  EXPECT_STATUS(c, hvp_client_solve(c->client, p.b, u, UNKNOWNS, LONG_NS), HVP_ERROR_SATURATED);
  // The matrix is as it was.
  EXPECT_OK(c, hvp_client_start(c->client));
  EXPECT_STATUS(c, hvp_client_wait(c->client, LONG_NS), HVP_ERROR_SATURATED);
}

const struct case_entry solve_cases[] = {
    {"solve", solves},
    {"solve-identity", solves_the_identity},
    {"solve-step-by-step", step_by_step},
    {"result", says_what_a_job_was},
    {"initial-guess", starts_from_a_guess},
    {"stop-residual", stops_at_a_residual},
    {"update-nodes", changes_nodes},
    {"update-values", case_update_values},
    {"methods", every_method},
    {"word-lengths", other_words},
    {"saturation", saturation_is_said},
    {NULL, NULL},
};
