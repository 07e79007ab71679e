#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "tests/linux/stress/stress.h"

// Threads that ask everything of a board at once, in an order that the seed draws. What else
// befalls the board is upheaval.sh's. Prints what each call came to; ends with 0, with 1 after a
// line that begins with FAILED, and with 2 for a wrong word.
//
//   hvp-stress BOARD ATTRIBUTES [--seed N] [--seconds N] [--begun FILE] [--loses-power]
//
// ATTRIBUTES is the function's folder in sysfs; FILE is made when the threads begin; --loses-power:
// the board may come back as after power-on, and says so of the next call.

// Longer than the longest wait, its own and those of the threads before it.
enum { LONGEST_CALL_S = 20 };

static int usage(void) {
  (void)fprintf(stderr,
                "hvp-stress: expected hvp-stress BOARD ATTRIBUTES [--seed N] [--seconds N] "
                "[--begun FILE] [--loses-power], with N from 1 to 1000000\n");
  return 2;
}

static bool take_number(const char* text, unsigned long* number) {
  char* end = NULL;
  *number = strtoul(text, &end, 10);
  return end != text && *end == '\0' && *number >= 1U && *number <= 1000000U;
}

static void show_tasks(void) {
  const int file = open("/proc/sysrq-trigger", O_WRONLY | O_CLOEXEC);
  if (file < 0) return;
  (void)!write(file, "w", 1);
  (void)close(file);
}

// Whether every call has returned in time, until all threads have ended.
static bool watch(struct stress* stress) {
  const struct timespec pause = {.tv_nsec = 100000000};
  const uint64_t last = stress->end_ns + (uint64_t)LONGEST_CALL_S * 1000000000U;
  while (stress_now_ns() < stress->end_ns && !atomic_load(&stress->failed)) {
    (void)nanosleep(&pause, NULL);
    for (int i = 0; i < STRESS_WORKERS; ++i) {
      const struct stress_worker* worker = &stress->workers[i];
      const uint64_t since = atomic_load(&worker->since_ns);
      if (since == 0U || stress_now_ns() < since + (uint64_t)LONGEST_CALL_S * 1000000000U) continue;
      const int operation = atomic_load(&worker->operation);
      stress_fail(stress, "%s has not returned for %d s",
                  stress_operation_name((enum stress_operation)operation), LONGEST_CALL_S);
      return false;
    }
  }
  for (int i = 0; i < STRESS_WORKERS; ++i) {
    const struct timespec until = {.tv_sec = (time_t)(last / 1000000000U)};
    if (pthread_clockjoin_np(stress->workers[i].thread, NULL, CLOCK_MONOTONIC, &until) != 0) {
      const int operation = atomic_load(&stress->workers[i].operation);
      stress_fail(stress, "at the end %s does not return",
                  stress_operation_name((enum stress_operation)operation));
      return false;
    }
  }
  return true;
}

static bool begin(struct stress* stress, unsigned long seed) {
  for (unsigned i = 0; i < STRESS_WORKERS; ++i) {
    struct stress_worker* worker = &stress->workers[i];
    worker->stress = stress;
    worker->number = i;
    worker->random = (seed * STRESS_WORKERS + i + 1U) * 0x9e3779b97f4a7c15U;
  }
  for (unsigned i = 0; i < STRESS_WORKERS; ++i) {
    struct stress_worker* worker = &stress->workers[i];
    if (pthread_create(&worker->thread, NULL, stress_work, worker) != 0) return false;
  }
  return true;
}

int main(int argc, char** argv) {
  static struct stress stress = {.descriptor = -1, .turns = PTHREAD_RWLOCK_INITIALIZER};
  unsigned long seed = 1U;
  unsigned long seconds = 60U;
  const char* begun = NULL;
  if (argc < 3) return usage();
  stress.board = argv[1];
  stress.attributes = argv[2];
  for (int i = 3; i < argc; ++i) {
    if (strcmp(argv[i], "--loses-power") == 0) {
      stress.loses_power = true;
    } else if (strcmp(argv[i], "--begun") == 0 && i + 1 < argc) {
      begun = argv[++i];
    } else if (strcmp(argv[i], "--seed") == 0 && i + 1 < argc) {
      if (!take_number(argv[++i], &seed)) return usage();
    } else if (strcmp(argv[i], "--seconds") == 0 && i + 1 < argc) {
      if (!take_number(argv[++i], &seconds)) return usage();
    } else {
      return usage();
    }
  }
  if (!stress_make_references(&stress.references, stress.board)) return 1;
  stress_take_signals();
  stress.end_ns = stress_now_ns() + (uint64_t)seconds * 1000000000U;
  if (!begin(&stress, seed)) {
    printf("FAILED: no room for threads\n");
    return 1;
  }
  if (begun != NULL) (void)close(open(begun, O_WRONLY | O_CREAT | O_CLOEXEC, 0600));
  const bool returned = watch(&stress);
  stress_report();
  if (!returned) {
    show_tasks();
    (void)fflush(stdout);
    // Not exit(), which would wait for what does not end.
    _exit(1);
  }
  return atomic_load(&stress.failed) ? 1 : 0;
}
