#include <stdlib.h>

#include "tests/driver/suite/case.h"

// Words of K of 12 bits; a node is held by 1000 of 2048 in its own directions.
enum { HELD = 1000, SHEAR = 60, SPRING = -200 };

static int32_t entry(int row, int column, int i, int j) {
  if (row != column) return i == j ? SPRING : 0;
  return i == j ? HELD + 3 * row : SHEAR;
}

void problem_make(struct problem* p) {
  int32_t blocks = 0;
  p->row_begin[0] = 0;
  for (int row = 0; row < NODES; ++row) {
    for (int column = row > 0 ? row - 1 : 0; column <= row + 1 && column < NODES; ++column) {
      p->column[blocks] = column;
      for (int e = 0; e < 9; ++e) p->value[9 * blocks + e] = entry(row, column, e / 3, e % 3);
      ++blocks;
    }
    p->row_begin[row + 1] = blocks;
  }
  for (int i = 0; i < UNKNOWNS; ++i) p->b[i] = (i * 389 + 100) % 1500 - 700;
}

struct hvp_matrix problem_matrix(const struct problem* p) {
  const struct hvp_matrix matrix = {.nodes = NODES,
                                    .blocks = BLOCKS,
                                    .row_begin = p->row_begin,
                                    .column = p->column,
                                    .value = p->value};
  return matrix;
}

struct hvp_solver_config problem_config(void) {
  const struct hvp_solver_config config = {.method = HVP_METHOD_CG,
                                           .start = HVP_START_FROM_ZERO,
                                           .iterations = 40,
                                           .static_shift = SHIFT,
                                           .dynamic_scaling = true,
                                           .headroom_bits = 1,
                                           .matrix_bits = 12,
                                           .vector_bits = 16,
                                           .coefficient_bits = 16};
  return config;
}

void problem_constrain(struct problem* p, uint32_t node, int32_t diagonal) {
  for (int row = 0; row < NODES; ++row) {
    for (int32_t k = p->row_begin[row]; k < p->row_begin[row + 1]; ++k) {
      const bool own = (uint32_t)row == node && (uint32_t)p->column[k] == node;
      if ((uint32_t)row != node && (uint32_t)p->column[k] != node) continue;
      for (int e = 0; e < 9; ++e) p->value[9 * k + e] = own && e % 4 == 0 ? diagonal : 0;
    }
  }
}

void problem_change(struct problem* p) {
  for (int row = 0; row < NODES; ++row) {
    for (int32_t k = p->row_begin[row]; k < p->row_begin[row + 1]; ++k) {
      const int first = row < p->column[k] ? row : p->column[k];
      const int32_t more = p->column[k] == row ? 100 : 3 * first;
      for (int e = 0; e < 9; e += 4) p->value[9 * k + e] += more;
    }
  }
}

int32_t problem_residual(const struct problem* p, const int32_t* u) {
  int64_t largest = 0;
  for (int row = 0; row < NODES; ++row) {
    for (int i = 0; i < 3; ++i) {
      int64_t sum = (int64_t)p->b[3 * row + i] * (1 << SHIFT);
      for (int32_t k = p->row_begin[row]; k < p->row_begin[row + 1]; ++k) {
        for (int j = 0; j < 3; ++j) {
          sum -= (int64_t)p->value[9 * k + 3 * i + j] * u[3 * p->column[k] + j];
        }
      }
      const int64_t words = (sum < 0 ? -sum : sum) >> SHIFT;
      if (words > largest) largest = words;
    }
  }
  return (int32_t)largest;
}

bool case_load(struct suite_case* c, const struct problem* p) {
  const struct hvp_solver_config config = problem_config();
  const struct hvp_matrix matrix = problem_matrix(p);
  return case_status(c, "configure", __LINE__, hvp_client_configure(c->client, &config), HVP_OK) &&
         case_status(c, "load", __LINE__, hvp_client_load_matrix(c->client, &matrix), HVP_OK);
}

bool case_begin_longest_job(struct suite_case* c, struct problem* p) {
  problem_make(p);
  struct hvp_solver_config config = problem_config();
  const struct hvp_matrix matrix = problem_matrix(p);
  config.iterations = 65535U;  // what the register holds
  return case_status(c, "configure", __LINE__, hvp_client_configure(c->client, &config), HVP_OK) &&
         case_status(c, "load", __LINE__, hvp_client_load_matrix(c->client, &matrix), HVP_OK) &&
         case_status(c, "write_rhs", __LINE__, hvp_client_write_rhs(c->client, p->b, UNKNOWNS),
                     HVP_OK) &&
         case_status(c, "start", __LINE__, hvp_client_start(c->client), HVP_OK);
}

// U is rounded to a word, and so is each product on the way: a few of them in b.
enum { TOLERANCE = 4 };

bool case_solve(struct suite_case* c, const struct problem* p, int32_t* u) {
  const hvp_status status = hvp_client_solve(c->client, p->b, u, UNKNOWNS, LONG_NS);
  if (!case_status(c, "solve", __LINE__, status, HVP_OK)) return false;
  const int32_t residual = problem_residual(p, u);
  if (residual > TOLERANCE) {
    case_end(c, CASE_FAILED, "K·U misses b by %d words, expected at most %d", (int)residual,
             TOLERANCE);
    return false;
  }
  case_hash(c, u, UNKNOWNS);
  return true;
}

// FNV-1a, over the words of every U in turn.
void case_hash(struct suite_case* c, const int32_t* u, size_t n) {
  uint32_t hash = c->words == 0U ? 2166136261U : c->words;
  for (size_t i = 0; i < n; ++i) {
    for (unsigned k = 0; k < 4U; ++k) {
      hash = (hash ^ ((uint32_t)u[i] >> 8U * k & 0xffU)) * 16777619U;
    }
  }
  c->words = hash;
}
