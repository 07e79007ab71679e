#ifndef HVP_SUITE_CASE_H
#define HVP_SUITE_CASE_H

#include "tests/driver/suite/suite.h"

// What the cases share: the suite's own.

enum case_result { CASE_PASSED, CASE_FAILED, CASE_SKIPPED };

// A case that is running: its client is open when it begins and closed when it ends.
struct suite_case {
  const struct suite_board* board;
  struct hvp_client* client;
  enum case_result result;
  char reason[256];
  uint32_t words;  // a hash of every U that was solved; 0: of none
};

struct case_entry {
  const char* name;
  void (*run)(struct suite_case* c);
};

// Groups of cases; the last entry has no name.
extern const struct case_entry setup_cases[];
extern const struct case_entry solve_cases[];
extern const struct case_entry wait_cases[];
extern const struct case_entry error_cases[];
extern const struct case_entry transfer_cases[];
extern const struct case_entry fault_cases[];

void case_end(struct suite_case* c, enum case_result result, const char* format, ...)
    __attribute__((format(printf, 3, 4)));
bool case_status(struct suite_case* c, const char* call, int line, hvp_status found,
                 hvp_status expected);

// Each leaves the case.
#define SKIP(c, ...)                          \
  do {                                        \
    case_end((c), CASE_SKIPPED, __VA_ARGS__); \
    return;                                   \
  } while (0)
#define EXPECT(c, condition)                                                   \
  do {                                                                         \
    if (!(condition)) {                                                        \
      case_end((c), CASE_FAILED, "line %d: not so: %s", __LINE__, #condition); \
      return;                                                                  \
    }                                                                          \
  } while (0)
#define EXPECT_STATUS(c, call, expected)                                \
  do {                                                                  \
    if (!case_status((c), #call, __LINE__, (call), (expected))) return; \
  } while (0)
#define EXPECT_OK(c, call) EXPECT_STATUS((c), call, HVP_OK)

// The problem of most cases: a chain of nodes, held by springs, and a load on it.
enum { NODES = 12, UNKNOWNS = 3 * NODES, BLOCKS = 3 * NODES - 2, SHIFT = 11 };
// More simulated time than any job here takes.
#define LONG_NS ((uint64_t)2000000000)

struct problem {
  int32_t row_begin[NODES + 1];
  int32_t column[BLOCKS];
  int32_t value[9 * BLOCKS];
  int32_t b[UNKNOWNS];
};
void problem_make(struct problem* p);
struct hvp_matrix problem_matrix(const struct problem* p);
// 12-bit words of K, 16-bit words of U, a fixed count of iterations from zero.
struct hvp_solver_config problem_config(void);
// Row and column of a node zeroed but for its diagonal, as the board does it.
void problem_constrain(struct problem* p, uint32_t node, int32_t diagonal);
// The largest |b − K·u/2^SHIFT|, in words.
int32_t problem_residual(const struct problem* p, const int32_t* u);

// Another matrix of the same pattern, that 12-bit words hold.
void problem_change(struct problem* p);

// From here on by DMA, where it is not so already. False: the case is left out, or has failed.
bool case_use_dma(struct suite_case* c);
// Configured, and loaded with the problem's matrix. False: the case has failed.
bool case_load(struct suite_case* c, const struct problem* p);
// A job as long as any: it takes milliseconds of the board. It is under way on return. False: the
// case has failed.
bool case_begin_longest_job(struct suite_case* c, struct problem* p);
#define NEEDS_TIME_TO_WAIT(c) \
  if ((c)->board->time_runs_on) SKIP(c, "the job may end before the next call here")
// Solved within what the words allow; keeps U's hash. False: the case has failed.
bool case_solve(struct suite_case* c, const struct problem* p, int32_t* u);
// Updates of all values between solves, also while a node is held.
void case_update_values(struct suite_case* c);
void case_hash(struct suite_case* c, const int32_t* u, size_t n);

#endif
