#include <string.h>

#include "tests/driver/suite/case.h"

// What docs/faults.md says that a driver does about each fault. The board brings it about in one of
// its first jobs; which one is the scenario's to say.

enum { MOST_JOBS = 40, FEW_TRIES = 5, MOST_TRIES = 100000 };

// What comes of a fault, beside a late frame.
struct expected {
  const char* kind;
  hvp_status status;  // of the job; HVP_OK: none fails
  bool or_time_out;   // where the bus has no take_errors, or the wait is shorter than the fault
  bool lost_interrupt;
  bool for_good;         // the board does not come back
  bool repaired;         // by the bus, so that nothing is seen
  bool may_stay_unseen;  // the driver sees it only where the bus has take_errors, or time passes
};

static const struct expected all[] = {
    {.kind = "lost-interrupt", .status = HVP_OK, .lost_interrupt = true},
    {.kind = "stuck-busy", .status = HVP_ERROR_TIMEOUT},
    {.kind = "saturated-solve", .status = HVP_ERROR_SATURATED},
    {.kind = "master-abort-rhs", .status = HVP_ERROR_BUS, .may_stay_unseen = true},
    {.kind = "master-abort-start", .status = HVP_ERROR_BUS, .or_time_out = true},
    {.kind = "master-abort-status", .status = HVP_ERROR_BUS},
    {.kind = "master-abort-acknowledge", .status = HVP_ERROR_BUS, .may_stay_unseen = true},
    {.kind = "master-abort-solution", .status = HVP_ERROR_BUS, .may_stay_unseen = true},
    {.kind = "corrupted-word-rhs", .status = HVP_ERROR_DATA, .may_stay_unseen = true},
    {.kind = "corrupted-word-solution", .status = HVP_ERROR_DATA, .may_stay_unseen = true},
    {.kind = "device-gone", .status = HVP_ERROR_BUS, .or_time_out = true},
    {.kind = "surprise-removal", .status = HVP_ERROR_BUS, .or_time_out = true, .for_good = true},
    {.kind = "function-level-reset", .status = HVP_ERROR_TIMEOUT},
    {.kind = "aer-correctable", .status = HVP_OK, .repaired = true},
    {.kind = "aer-uncorrectable", .status = HVP_ERROR_DATA, .or_time_out = true},
    {.kind = "late-dma", .status = HVP_OK, .or_time_out = true, .may_stay_unseen = true},
    {.kind = "truncated-dma", .status = HVP_ERROR_SHORT_TRANSFER},
};

// Longer than any job here, and what a fault that holds a job up costs.
#define FAULT_NS ((uint64_t)20000000)

static hvp_status set_up(struct suite_case* c, const struct problem* p) {
  const struct hvp_matrix matrix = problem_matrix(p);
  struct hvp_solver_config config = problem_config();
  config.reject_saturated = true;
  const hvp_status status = hvp_client_configure(c->client, &config);
  return status == HVP_OK ? hvp_client_load_matrix(c->client, &matrix) : status;
}

// A board that is gone comes back after a while: it is asked again and again.
static bool comes_back(struct suite_case* c, const struct problem* p) {
  hvp_status status = HVP_ERROR_BUS;
  for (int tries = 0; tries < MOST_TRIES && status != HVP_OK; ++tries) {
    status = hvp_client_reset(c->client);
    if (status == HVP_OK) status = set_up(c, p);
  }
  return case_status(c, "set-up after the fault", __LINE__, status, HVP_OK);
}

// No set-up goes well, and no job, however often it is tried.
static void stays_away(struct suite_case* c, const struct problem* p) {
  int32_t u[UNKNOWNS];
  for (int tries = 0; tries < FEW_TRIES; ++tries) {
    EXPECT(c, hvp_client_reset(c->client) != HVP_OK);
    EXPECT(c, set_up(c, p) != HVP_OK);
    EXPECT(c, hvp_client_solve(c->client, p->b, u, UNKNOWNS, FAULT_NS) != HVP_OK);
  }
}

static void faulty(struct suite_case* c, const struct expected* expected) {
  struct problem p;
  int32_t right[UNKNOWNS];
  int32_t u[UNKNOWNS];
  struct hvp_statistics before;
  struct hvp_statistics after;
  problem_make(&p);
  EXPECT_OK(c, hvp_client_statistics(c->client, &before));
  if (strstr(expected->kind, "-dma") != NULL && !case_use_dma(c)) return;
  EXPECT_OK(c, set_up(c, &p));
  EXPECT_OK(c, hvp_client_solve(c->client, p.b, right, UNKNOWNS, FAULT_NS));
  EXPECT(c, problem_residual(&p, right) <= 4);
  bool seen = false;
  for (int job = 0; job < MOST_JOBS; ++job) {
    const hvp_status status = hvp_client_solve(c->client, p.b, u, UNKNOWNS, FAULT_NS);
    if (status != HVP_OK) {
      if (status != HVP_ERROR_TIMEOUT || !expected->or_time_out) {
        EXPECT_STATUS(c, status, expected->status);
      }
      seen = true;
      if (expected->for_good) {
        stays_away(c, &p);
        return;
      }
      if (status != HVP_ERROR_SATURATED && !comes_back(c, &p)) return;
    } else if (memcmp(u, right, sizeof u) != 0) {
      // Wrong words that nobody noticed are right where nobody can.
      EXPECT(c, expected->may_stay_unseen);
      seen = true;
    }
  }
  EXPECT_OK(c, hvp_client_statistics(c->client, &after));
  if (expected->lost_interrupt) seen = seen || after.lost_interrupts > before.lost_interrupts;
  if (!seen && expected->may_stay_unseen) SKIP(c, "the driver cannot see it here");
  EXPECT(c, seen != expected->repaired);
  // Over: the words are those of before it.
  EXPECT_OK(c, hvp_client_solve(c->client, p.b, u, UNKNOWNS, FAULT_NS));
  EXPECT(c, memcmp(u, right, sizeof u) == 0);
  case_hash(c, u, UNKNOWNS);
}

static void run_kind(struct suite_case* c, const char* kind) {
  if (c->board->fault == NULL || strcmp(c->board->fault, kind) != 0) {
    SKIP(c, "nothing here brings it about: --fault %s, with a scenario that has it", kind);
  }
  for (size_t i = 0; i < sizeof all / sizeof all[0]; ++i) {
    if (strcmp(all[i].kind, kind) == 0) faulty(c, &all[i]);
  }
}

#define FAULT(function, kind) \
  static void function(struct suite_case* c) { run_kind(c, kind); }

FAULT(lost_interrupt, "lost-interrupt")
FAULT(stuck_busy, "stuck-busy")
FAULT(saturated_solve, "saturated-solve")
FAULT(abort_rhs, "master-abort-rhs")
FAULT(abort_start, "master-abort-start")
FAULT(abort_status, "master-abort-status")
FAULT(abort_acknowledge, "master-abort-acknowledge")
FAULT(abort_solution, "master-abort-solution")
FAULT(corrupted_rhs, "corrupted-word-rhs")
FAULT(corrupted_solution, "corrupted-word-solution")
FAULT(device_gone, "device-gone")
FAULT(surprise_removal, "surprise-removal")
FAULT(function_level_reset, "function-level-reset")
FAULT(aer_correctable, "aer-correctable")
FAULT(aer_uncorrectable, "aer-uncorrectable")
FAULT(late_dma, "late-dma")
FAULT(truncated_dma, "truncated-dma")

const struct case_entry fault_cases[] = {
    {"fault-lost-interrupt", lost_interrupt},
    {"fault-stuck-busy", stuck_busy},
    {"fault-saturated-solve", saturated_solve},
    {"fault-master-abort-rhs", abort_rhs},
    {"fault-master-abort-start", abort_start},
    {"fault-master-abort-status", abort_status},
    {"fault-master-abort-acknowledge", abort_acknowledge},
    {"fault-master-abort-solution", abort_solution},
    {"fault-corrupted-word-rhs", corrupted_rhs},
    {"fault-corrupted-word-solution", corrupted_solution},
    {"fault-device-gone", device_gone},
    {"fault-surprise-removal", surprise_removal},
    {"fault-function-level-reset", function_level_reset},
    {"fault-aer-correctable", aer_correctable},
    {"fault-aer-uncorrectable", aer_uncorrectable},
    {"fault-late-dma", late_dma},
    {"fault-truncated-dma", truncated_dma},
    {NULL, NULL},
};
