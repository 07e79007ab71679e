#include <errno.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "driver/hvp_errno.h"
#include "tests/linux/stress/stress.h"

// What a call may come to while boards are taken away under it, and what it came to.

static const char* const names[STRESS_OPERATIONS] = {
    [STRESS_OPEN] = "open",
    [STRESS_CLOSE] = "close",
    [STRESS_INFO] = "info",
    [STRESS_STATISTICS] = "statistics",
    [STRESS_RESET] = "reset",
    [STRESS_CONFIGURE] = "configure",
    [STRESS_LOAD] = "load",
    [STRESS_CONSTRAIN] = "constrain",
    [STRESS_RESTORE] = "restore",
    [STRESS_WRITE_RHS] = "write-rhs",
    [STRESS_WRITE_GUESS] = "write-guess",
    [STRESS_START] = "start",
    [STRESS_WAIT] = "wait",
    [STRESS_POLL] = "poll",
    [STRESS_READ_SOLUTION] = "read-solution",
    [STRESS_READ_RESULT] = "read-result",
    [STRESS_SOLVE] = "solve",
    [STRESS_MAP] = "map",
    [STRESS_WRONG] = "wrong",
    [STRESS_ATTRIBUTE] = "attribute",
};

const char* stress_operation_name(enum stress_operation operation) { return names[operation]; }

#define BIT(status) (1UL << (unsigned)(status))
// A board that is away, that was reset, or whose last job nobody knows the end of.
#define AWAY (BIT(HVP_OK) | BIT(HVP_ERROR_STATE) | BIT(HVP_ERROR_BUS) | BIT(HVP_ERROR_NO_DEVICE))
#define HEARD (AWAY | BIT(HVP_ERROR_DATA))
#define WAITED (HEARD | BIT(HVP_ERROR_TIMEOUT) | BIT(HVP_ERROR_INTERRUPTED))
#define JOB \
  (WAITED | BIT(HVP_ERROR_STALE_RESULT) | BIT(HVP_ERROR_SHORT_TRANSFER) | BIT(HVP_ERROR_SATURATED))
// What a board says that has lost its settings, its matrix and the addresses of its engine.
#define POWER_LOST                                                                    \
  (BIT(HVP_ERROR_NOT_LOADED) | BIT(HVP_ERROR_BAD_SETTING) | BIT(HVP_ERROR_BAD_SIZE) | \
   BIT(HVP_ERROR_BAD_MATRIX) | BIT(HVP_ERROR_BAD_NODE) | BIT(HVP_ERROR_BAD_ROW) |     \
   BIT(HVP_ERROR_BAD_DESCRIPTOR) | BIT(HVP_ERROR_DMA) | BIT(HVP_ERROR_BOARD))

static unsigned long allowed(const struct stress* stress, enum stress_operation operation) {
  const unsigned long lost = stress->loses_power ? POWER_LOST : 0UL;
  switch (operation) {
    case STRESS_INFO:
    case STRESS_STATISTICS:
      return BIT(HVP_OK);
    case STRESS_RESET:
      return HEARD | (lost & BIT(HVP_ERROR_BOARD));
    case STRESS_LOAD:
      return WAITED | lost;
    case STRESS_WAIT:
    case STRESS_SOLVE:
      return JOB | lost;
    case STRESS_READ_RESULT:
      return HEARD | BIT(HVP_ERROR_STALE_RESULT);
    default:
      return HEARD;
  }
}

enum { ROWS = 24, NAME = 32 };
static struct {
  char outcome[NAME];
  unsigned long count;
} counts[STRESS_OPERATIONS][ROWS];
static pthread_mutex_t counting = PTHREAD_MUTEX_INITIALIZER;

void stress_count(enum stress_operation operation, const char* outcome) {
  pthread_mutex_lock(&counting);
  for (int row = 0; row < ROWS; ++row) {
    if (counts[operation][row].count == 0U) {
      (void)snprintf(counts[operation][row].outcome, NAME, "%s", outcome);
    }
    if (strncmp(counts[operation][row].outcome, outcome, NAME - 1) != 0) continue;
    ++counts[operation][row].count;
    break;
  }
  pthread_mutex_unlock(&counting);
}

void stress_report(void) {
  for (int operation = 0; operation < STRESS_OPERATIONS; ++operation) {
    for (int row = 0; row < ROWS && counts[operation][row].count > 0U; ++row) {
      printf("stress: %-14s %-26s %7lu\n", names[operation], counts[operation][row].outcome,
             counts[operation][row].count);
    }
  }
}

void stress_fail(struct stress* stress, const char* format, ...) {
  char line[256];
  va_list words;
  va_start(words, format);
  (void)vsnprintf(line, sizeof line, format, words);
  va_end(words);
  printf("FAILED: %s\n", line);
  (void)fflush(stdout);
  atomic_store(&stress->failed, true);
}

void stress_begin(struct stress_worker* worker, enum stress_operation operation) {
  atomic_store(&worker->operation, (int)operation);
  atomic_store(&worker->since_ns, stress_now_ns());
}

void stress_end(struct stress_worker* worker) { atomic_store(&worker->since_ns, 0U); }

static __thread volatile sig_atomic_t signals;

static void count_signal(int number) {
  (void)number;
  ++signals;
}

unsigned stress_signals(void) { return (unsigned)signals; }

// Without SA_RESTART: a call that is interrupted says so.
void stress_take_signals(void) {
  struct sigaction action;
  memset(&action, 0, sizeof action);
  action.sa_handler = count_signal;
  (void)sigaction(SIGUSR1, &action, NULL);
}

static const char* error_name(int error) {
  const char* name = strerrorname_np(error);
  return name == NULL ? "?" : name;
}

hvp_status stress_judge(struct stress_worker* worker, enum stress_operation operation,
                        const struct hvp_ioc_head* head, int outcome, int error, bool signalled) {
  struct stress* stress = worker->stress;
  const char* name = names[operation];
  if (head->status == HVP_IOC_UNTOUCHED) {
    // A file that another thread has closed; a signal. No call ends with EINTR by itself.
    stress_count(operation, error_name(error));
    if (outcome == 0) {
      stress_fail(stress, "%s: 0, and no status", name);
    } else if (error == EINTR && !signalled) {
      stress_fail(stress, "%s: EINTR, and no handler ran", name);
    } else if (error != EINTR && error != EBADF) {
      stress_fail(stress, "%s: %s", name, error_name(error));
    }
    return HVP_STATUS_COUNT;
  }
  if (head->status >= HVP_STATUS_COUNT) {
    stress_fail(stress, "%s: a status %u", name, head->status);
    return HVP_STATUS_COUNT;
  }
  const hvp_status status = (hvp_status)head->status;
  stress_count(operation, hvp_status_name(status));
  if ((allowed(stress, operation) & BIT(status)) == 0UL) {
    stress_fail(stress, "%s: %s, detail 0x%x", name, hvp_status_name(status), head->detail);
  }
  if ((outcome == 0 ? 0 : error) != hvp_errno_of(status)) {
    stress_fail(stress, "%s: %s with %s", name, hvp_status_name(status), error_name(error));
  }
  // What may be repeated is, where no handler ran.
  if (status == HVP_ERROR_INTERRUPTED && operation != STRESS_SOLVE && !signalled) {
    stress_fail(stress, "%s: interrupted, and no handler ran", name);
  }
  return status;
}

bool stress_judge_error(struct stress_worker* worker, enum stress_operation operation, int error,
                        const int* allowed_errors) {
  stress_count(operation, error == 0 ? "done" : error_name(error));
  if (error == 0) return true;
  while (*allowed_errors != 0 && *allowed_errors != error) ++allowed_errors;
  if (*allowed_errors == 0) {
    stress_fail(worker->stress, "%s: %s", names[operation], error_name(error));
  }
  return false;
}
