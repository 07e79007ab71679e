#include <stdio.h>
#include <string.h>

#include "tests/linux/stress/stress.h"

struct hvp_solver_config stress_config(unsigned length) {
  struct hvp_solver_config config = problem_config();
  if (length == 1U) config.iterations = 3000U;
  // A board whose words were all at their limit says so.
  config.reject_saturated = true;
  return config;
}

// Faults strike here too; one that comes back this often is none of the scenario's.
enum { TRIES = 30 };

static hvp_status set_up(const struct stress_references* r, struct hvp_client* client,
                         unsigned length, unsigned matrix) {
  const struct hvp_solver_config config = stress_config(length);
  const struct hvp_matrix whole = problem_matrix(&r->problem);
  hvp_status status = hvp_client_reset(client);
  if (status == HVP_OK) status = hvp_client_configure(client, &config);
  if (status == HVP_OK) status = hvp_client_load_matrix(client, &whole);
  if (status == HVP_OK && matrix == 1U) {
    status = hvp_client_constrain_node(client, STRESS_HELD_NODE, STRESS_DIAGONAL);
  }
  return status;
}

static bool solve(struct stress_references* r, struct hvp_client* client, unsigned length,
                  unsigned matrix, unsigned rhs) {
  struct problem problem = r->problem;
  int32_t* u = r->u[length][matrix][rhs];
  hvp_status status = HVP_ERROR_STATE;
  if (matrix == 1U) problem_constrain(&problem, STRESS_HELD_NODE, STRESS_DIAGONAL);
  memcpy(problem.b, r->b[rhs], sizeof problem.b);
  for (int tries = 0; tries < TRIES && status != HVP_OK; ++tries) {
    status = set_up(r, client, length, matrix);
    if (status == HVP_OK) status = hvp_client_solve(client, problem.b, u, UNKNOWNS, LONG_NS);
  }
  // What is wrong from the beginning cannot show what goes wrong later.
  if (status == HVP_OK && problem_residual(&problem, u) <= 8) return true;
  printf("FAILED: before the stress: b %u: %s, or a wrong U\n", rhs, hvp_status_name(status));
  return false;
}

bool stress_make_references(struct stress_references* r, const char* board) {
  problem_make(&r->problem);
  for (int rhs = 0; rhs < STRESS_RHS; ++rhs) {
    for (int i = 0; i < UNKNOWNS; ++i) r->b[rhs][i] = (i * 389 + 271 * rhs + 100) % 1500 - 700;
  }
  struct hvp_client* client = NULL;
  const hvp_status status = hvp_client_open(&client, board);
  if (status != HVP_OK) {
    printf("FAILED: before the stress: open: %s\n", hvp_status_name(status));
    return false;
  }
  bool made = true;
  for (unsigned length = 0; length < STRESS_LENGTHS; ++length) {
    for (unsigned matrix = 0; matrix < STRESS_MATRICES; ++matrix) {
      for (unsigned rhs = 0; made && rhs < STRESS_RHS; ++rhs) {
        made = solve(r, client, length, matrix, rhs);
      }
    }
  }
  (void)hvp_client_close(client);
  return made;
}

bool stress_is_solution(const struct stress_references* r, unsigned rhs, const int32_t* u) {
  for (unsigned length = 0; length < STRESS_LENGTHS; ++length) {
    for (unsigned matrix = 0; matrix < STRESS_MATRICES; ++matrix) {
      if (memcmp(r->u[length][matrix][rhs], u, sizeof r->u[length][matrix][rhs]) == 0) return true;
    }
  }
  return false;
}
