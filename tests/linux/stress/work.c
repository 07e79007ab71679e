#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>

#include "tests/linux/stress/calls.h"

// What a thread does next, and what belongs together.

enum { MS = 1000000, PAGE = 4096 };

uint64_t stress_now_ns(void) {
  struct timespec now;
  (void)clock_gettime(CLOCK_MONOTONIC, &now);
  return (uint64_t)now.tv_sec * 1000000000U + (uint64_t)now.tv_nsec;
}

// xorshift64*: the same numbers everywhere.
uint32_t stress_draw(struct stress_worker* worker, uint32_t limit) {
  uint64_t x = worker->random;
  x ^= x >> 12U;
  x ^= x << 25U;
  x ^= x >> 27U;
  worker->random = x;
  return (uint32_t)((x * 0x2545f4914f6cdd1dU) >> 32U) % limit;
}

static uint64_t some_patience(struct stress_worker* worker) {
  static const uint64_t choices[] = {0U, 20000U, 200000U, 3U * MS, 40U * MS};
  return choices[stress_draw(worker, sizeof choices / sizeof *choices)];
}

static void expect_solution(struct stress_worker* worker, bool right, const char* what) {
  if (!right) stress_fail(worker->stress, "%s: the words of U are those of no b", what);
}

static void set_up(struct stress_worker* worker) {
  const hvp_status status = stress_configure(worker);
  if (status == HVP_ERROR_STATE) (void)stress_reset(worker);
  if (status == HVP_OK) (void)stress_load(worker);
}

// A program that goes on after an error: mostly it does what the error asks for.
static void answer(struct stress_worker* worker, hvp_status status) {
  if (stress_draw(worker, 3U) == 0U) return;
  if (status == HVP_ERROR_NO_DEVICE) stress_close(worker);
  if (status == HVP_ERROR_STATE) set_up(worker);
  if (status == HVP_ERROR_BUS || status == HVP_ERROR_TIMEOUT) (void)stress_reset(worker);
}

static void solve(struct stress_worker* worker) {
  int32_t u[UNKNOWNS];
  const unsigned rhs = stress_draw(worker, STRESS_RHS);
  const uint64_t timeout = stress_draw(worker, 3U) == 0U ? some_patience(worker) : 40U * MS;
  const hvp_status status = stress_solve(worker, rhs, timeout, u);
  if (status == HVP_OK) {
    expect_solution(worker, stress_is_solution(&worker->stress->references, rhs, u), "solve");
  }
  answer(worker, status);
}

// The calls of a job one by one, those of other threads in between.
static void go_through_a_job(struct stress_worker* worker) {
  int32_t u[UNKNOWNS];
  if (stress_write(worker, STRESS_WRITE_RHS, stress_draw(worker, STRESS_RHS)) != HVP_OK) return;
  if (stress_start(worker) != HVP_OK) return;
  if (stress_draw(worker, 2U) == 0U) (void)stress_poll(worker, 5);
  if (stress_wait(worker, some_patience(worker)) != HVP_OK) return;
  // A load of another thread's may come in between: then it is the U before.
  (void)stress_read_solution(worker, u);
  (void)stress_read_result(worker);
}

// Nobody else asks: who waits for a job by poll() hears of its end, and of its loss too.
static void wait_by_poll(struct stress_worker* worker) {
  enum { LONG_MS = 1500 };
  int32_t u[UNKNOWNS];
  const unsigned rhs = stress_draw(worker, STRESS_RHS);
  if (stress_write(worker, STRESS_WRITE_RHS, rhs) != HVP_OK) return;
  if (stress_start(worker) != HVP_OK) return;
  const bool heard = stress_poll(worker, LONG_MS);
  const hvp_status status = stress_wait(worker, heard ? 40U * MS : 0U);
  if (!heard && status == HVP_ERROR_STATE) {
    stress_fail(worker->stress, "poll: slept for %d ms, and the job had been lost", LONG_MS);
  }
  if (status != HVP_OK || stress_read_solution(worker, u) != HVP_OK) return;
  expect_solution(worker, stress_is_solution(&worker->stress->references, rhs, u), "poll");
}

// Elements of 16 bits are two in a word, which is how a processor of this byte order has them.
static void solve_in_mapped_memory(struct stress_worker* worker) {
  struct hvp_ioc_info info = {.flags = 0U};
  if (stress_info(worker, &info) != HVP_OK || (info.flags & HVP_IOC_F_DMA) == 0U) return;
  int16_t* b = stress_map(worker, HVP_IOC_MAP_RHS, info.rhs_bytes);
  const int16_t* solution =
      b == NULL ? NULL : stress_map(worker, HVP_IOC_MAP_SOLUTION, info.solution_bytes);
  if (solution != NULL) {
    const unsigned rhs = stress_draw(worker, STRESS_RHS);
    for (int i = 0; i < UNKNOWNS; ++i) b[i] = (int16_t)worker->stress->references.b[rhs][i];
    hvp_status status = stress_start(worker);
    if (status == HVP_OK) status = stress_wait(worker, 40U * MS);
    if (status == HVP_OK) {
      int32_t u[UNKNOWNS];
      for (int i = 0; i < UNKNOWNS; ++i) u[i] = solution[i];
      expect_solution(worker, stress_is_solution(&worker->stress->references, rhs, u), "map");
    }
    (void)munmap((void*)solution, info.solution_bytes);
  }
  if (b != NULL) (void)munmap(b, info.rhs_bytes);
}

static void unmap(struct stress_worker* worker, unsigned slot) {
  const volatile uint8_t* bytes = worker->maps[slot];
  if (bytes == NULL) return;
  for (size_t at = 0; at < PAGE; at += 64U) (void)bytes[at];
  (void)munmap(worker->maps[slot], PAGE);
  worker->maps[slot] = NULL;
}

// What a program has mapped it keeps, whatever becomes of the board meanwhile.
static void map_or_unmap(struct stress_worker* worker) {
  static const uint32_t which[STRESS_MAPS] = {HVP_IOC_MAP_RHS, HVP_IOC_MAP_SOLUTION};
  const unsigned slot = stress_draw(worker, STRESS_MAPS);
  if (worker->maps[slot] != NULL) {
    unmap(worker, slot);
  } else {
    worker->maps[slot] = stress_map(worker, which[slot], PAGE);
  }
}

static void disturb_another(struct stress_worker* worker) {
  struct stress* stress = worker->stress;
  const unsigned other = stress_draw(worker, STRESS_WORKERS);
  if (other != worker->number) (void)pthread_kill(stress->workers[other].thread, SIGUSR1);
}

static void read_and_write(struct stress_worker* worker) {
  struct hvp_ioc_info info = {.flags = 0U};
  switch (stress_draw(worker, 6U)) {
    case 0:
      (void)stress_info(worker, &info);
      break;
    case 1:
      (void)stress_statistics(worker);
      break;
    case 2:
      (void)stress_write(worker, STRESS_WRITE_GUESS, stress_draw(worker, STRESS_RHS));
      break;
    case 3:
      (void)stress_read_result(worker);
      break;
    case 4:
      stress_ask_wrongly(worker);
      break;
    default:
      stress_read_attribute(worker);
      break;
  }
}

static void do_among_others(struct stress_worker* worker) {
  const uint32_t drawn = stress_draw(worker, 100U);
  if (atomic_load(&worker->stress->descriptor) < 0) {
    // As long as one has it mapped the file is open.
    for (unsigned slot = 0; slot < STRESS_MAPS; ++slot) unmap(worker, slot);
    stress_open(worker);
    set_up(worker);
  } else if (drawn < 35U) {
    solve(worker);
  } else if (drawn < 50U) {
    go_through_a_job(worker);
  } else if (drawn < 58U) {
    set_up(worker);
  } else if (drawn < 62U) {
    (void)stress_constrain(worker);
  } else if (drawn < 66U) {
    (void)stress_restore(worker);
  } else if (drawn < 69U) {
    (void)stress_start(worker);
  } else if (drawn < 72U) {
    (void)stress_wait(worker, some_patience(worker));
  } else if (drawn < 74U) {
    (void)stress_reset(worker);
  } else if (drawn < 81U) {
    map_or_unmap(worker);
  } else if (drawn < 82U) {
    stress_close(worker);
  } else if (drawn < 85U) {
    disturb_another(worker);
  } else if (drawn < 87U) {
    (void)stress_poll(worker, 2);
  } else {
    read_and_write(worker);
  }
}

static void do_alone(struct stress_worker* worker) {
  if (stress_draw(worker, 2U) == 0U) set_up(worker);
  if (stress_draw(worker, 2U) == 0U) {
    wait_by_poll(worker);
  } else {
    solve_in_mapped_memory(worker);
  }
}

void* stress_work(void* context) {
  struct stress_worker* worker = context;
  struct stress* stress = worker->stress;
  while (stress_now_ns() < stress->end_ns && !atomic_load(&stress->failed)) {
    if (stress_draw(worker, 20U) == 0U) {
      pthread_rwlock_wrlock(&stress->turns);
      do_alone(worker);
    } else {
      pthread_rwlock_rdlock(&stress->turns);
      do_among_others(worker);
    }
    pthread_rwlock_unlock(&stress->turns);
    const struct timespec pause = {.tv_nsec = 50000 + (long)stress_draw(worker, 6000000U)};
    (void)nanosleep(&pause, NULL);
  }
  for (unsigned slot = 0; slot < STRESS_MAPS; ++slot) unmap(worker, slot);
  return NULL;
}
