#include <errno.h>

#include "driver/generated/hvp_registers.h"
#include "tests/driver/suite/case.h"

// Every code of the board's ERROR register. What the driver does not let through is done beside it.

#define AT(name) ((uint32_t)offsetof(hvp_t, name))

static bool loaded(struct suite_case* c, struct problem* p) {
  problem_make(p);
  return case_load(c, p);
}

// What somebody did to the board is reported by the next job, which ends with it; the board works
// again after a reset.
static void reported(struct suite_case* c, const struct problem* p, hvp_status expected,
                     uint32_t detail) {
  int32_t u[UNKNOWNS];
  EXPECT_OK(c, hvp_client_start(c->client));
  EXPECT_STATUS(c, hvp_client_wait(c->client, LONG_NS), expected);
  EXPECT(c, hvp_client_error_detail(c->client) == detail);
  EXPECT_OK(c, hvp_client_reset(c->client));
  if (!case_load(c, p)) return;
  (void)case_solve(c, p, u);
}

#define POKES(c) \
  if ((c)->board->poke == NULL) SKIP(c, "no way to the registers beside the driver")

static void poke(const struct suite_case* c, uint32_t offset, uint32_t value) {
  c->board->poke(c->board->context, offset, value);
}

static void bad_setting(struct suite_case* c) {
  struct problem p;
  if (!loaded(c, &p)) return;
  struct hvp_solver_config config = problem_config();
  // The register has room for it, the board does not.
  config.static_shift = 63U;
  EXPECT_OK(c, hvp_client_configure(c->client, &config));
  reported(c, &p, HVP_ERROR_BAD_SETTING, AT(STATIC_SHIFT));
}

static void bad_row(struct suite_case* c) {
  struct problem p;
  if (!loaded(c, &p)) return;
  EXPECT_OK(c, hvp_client_restore_node(c->client, 5U, p.value, 2U));
  reported(c, &p, HVP_ERROR_BAD_ROW, 3U);
}

static void bad_node(struct suite_case* c) {
  struct problem p;
  if (!loaded(c, &p)) return;
  EXPECT_STATUS(c, hvp_client_constrain_node(c->client, NODES, 1), HVP_ERROR_BAD_NODE);
  EXPECT(c, errno == EINVAL);
  POKES(c);
  poke(c, AT(UPDATE_NODE), NODES);
  poke(c, AT(CONTROL), HVP__CONTROL__UPDATE_NODE_bm);
  reported(c, &p, HVP_ERROR_BAD_NODE, NODES);
}

static void bad_size(struct suite_case* c) {
  struct problem p;
  POKES(c);
  if (!loaded(c, &p)) return;
  poke(c, AT(NODES), 0U);
  poke(c, AT(CONTROL), HVP__CONTROL__LOAD_DONE_bm);
  reported(c, &p, HVP_ERROR_BAD_SIZE, 0U);
}

static void bad_matrix(struct suite_case* c) {
  struct problem p;
  POKES(c);
  if (!loaded(c, &p)) return;
  poke(c, AT(COLUMN) + 4U * (uint32_t)p.row_begin[4], NODES - 1U);
  poke(c, AT(CONTROL), HVP__CONTROL__LOAD_DONE_bm);
  reported(c, &p, HVP_ERROR_BAD_MATRIX, 4U);
}

static void not_loaded(struct suite_case* c) {
  struct problem p;
  POKES(c);
  if (!loaded(c, &p)) return;
  poke(c, AT(VALUE), 0U);
  reported(c, &p, HVP_ERROR_NOT_LOADED, 0U);
}

static void illegal_access(struct suite_case* c) {
  struct problem p;
  POKES(c);
  if (!loaded(c, &p)) return;
  poke(c, AT(STATUS), 1U);
  reported(c, &p, HVP_ERROR_ILLEGAL_ACCESS, AT(STATUS));
}

// The first is kept, and does not end a job that runs.
static void illegal_access_in_a_job(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  POKES(c);
  NEEDS_TIME_TO_WAIT(c);
  if (!case_begin_longest_job(c, &p)) return;
  poke(c, AT(METHOD), 1U);
  poke(c, AT(ID), 1U);
  EXPECT_STATUS(c, hvp_client_wait(c->client, LONG_NS), HVP_ERROR_ILLEGAL_ACCESS);
  EXPECT(c, hvp_client_error_detail(c->client) == AT(METHOD));
  EXPECT_OK(c, hvp_client_wait(c->client, LONG_NS));
  EXPECT_OK(c, hvp_client_read_solution(c->client, u, UNKNOWNS));
  EXPECT(c, problem_residual(&p, u) <= 4);
}

static void internal_fault(struct suite_case* c) {
  SKIP(c, "no board brings one about when it is asked to");
}

static void stale_result(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  struct hvp_result result;
  POKES(c);
  if (!loaded(c, &p) || !case_solve(c, &p, u)) return;
  poke(c, AT(CONTROL), HVP__CONTROL__START_bm);
  // The job that nobody knows of ends like the driver's own.
  for (int looks = 0; looks < 100000; ++looks) {
    if ((c->board->peek(c->board->context, AT(STATUS)) & HVP__STATUS__BUSY_bm) == 0U) break;
  }
  EXPECT_STATUS(c, hvp_client_read_result(c->client, &result), HVP_ERROR_STALE_RESULT);
  EXPECT(c, errno == ESTALE);
}

static void range(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  if (!loaded(c, &p)) return;
  p.b[7] = 32768;
  EXPECT_STATUS(c, hvp_client_write_rhs(c->client, p.b, UNKNOWNS), HVP_ERROR_RANGE);
  EXPECT_STATUS(c, hvp_client_constrain_node(c->client, 1U, 2048), HVP_ERROR_RANGE);
  problem_make(&p);
  (void)case_solve(c, &p, u);
}

const struct case_entry error_cases[] = {
    {"error-range", range},
    {"error-bad-size", bad_size},
    {"error-bad-matrix", bad_matrix},
    {"error-bad-setting", bad_setting},
    {"error-not-loaded", not_loaded},
    {"error-bad-node", bad_node},
    {"error-bad-row", bad_row},
    {"error-illegal-access", illegal_access},
    {"error-illegal-access-in-a-job", illegal_access_in_a_job},
    {"error-internal-fault", internal_fault},
    {"error-stale-result", stale_result},
    {NULL, NULL},
};
