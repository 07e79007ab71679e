#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/driver/suite/case.h"

// Waits: too short, interrupted, by poll(), and what a reset does to them.

// Short beside the longest job.
#define SHORT_NS ((uint64_t)1000)

static void time_out(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  NEEDS_TIME_TO_WAIT(c);
  if (!case_begin_longest_job(c, &p)) return;
  EXPECT_STATUS(c, hvp_client_wait(c->client, SHORT_NS), HVP_ERROR_TIMEOUT);
  EXPECT(c, errno == ETIMEDOUT);
  // The job goes on, and nothing else is allowed.
  EXPECT_STATUS(c, hvp_client_write_rhs(c->client, p.b, UNKNOWNS), HVP_ERROR_STATE);
  EXPECT_OK(c, hvp_client_wait(c->client, LONG_NS));
  EXPECT_OK(c, hvp_client_read_solution(c->client, u, UNKNOWNS));
  EXPECT(c, problem_residual(&p, u) <= 4);
  case_hash(c, u, UNKNOWNS);
}

static void no_time_at_all(struct suite_case* c) {
  struct problem p;
  if (!case_begin_longest_job(c, &p)) return;
  const hvp_status status = hvp_client_wait(c->client, 0U);
  EXPECT(c, status == HVP_ERROR_TIMEOUT || status == HVP_OK);
  if (status == HVP_ERROR_TIMEOUT) EXPECT_OK(c, hvp_client_wait(c->client, LONG_NS));
  EXPECT_STATUS(c, hvp_client_wait(c->client, 0U), HVP_ERROR_STATE);
}

static void reset_ends_a_job(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  if (!case_begin_longest_job(c, &p)) return;
  EXPECT_OK(c, hvp_client_reset(c->client));
  EXPECT_STATUS(c, hvp_client_wait(c->client, LONG_NS), HVP_ERROR_STATE);
  if (!case_load(c, &p)) return;
  (void)case_solve(c, &p, u);
}

static void close_ends_a_job(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  if (!case_begin_longest_job(c, &p)) return;
  EXPECT_OK(c, hvp_client_close(c->client));
  c->client = NULL;
  EXPECT_OK(c, c->board->open(c->board->context, &c->client));
  if (!case_load(c, &p)) return;
  (void)case_solve(c, &p, u);
}

static void is_over(struct suite_case* c, const struct problem* p) {
  int32_t u[UNKNOWNS];
  EXPECT_OK(c, hvp_client_wait(c->client, LONG_NS));
  EXPECT_OK(c, hvp_client_read_solution(c->client, u, UNKNOWNS));
  EXPECT(c, problem_residual(p, u) <= 4);
  case_hash(c, u, UNKNOWNS);
}

static void interrupted_by_the_bus(struct suite_case* c) {
  struct problem p;
  if (c->board->interrupt_wait == NULL) SKIP(c, "nothing here gives up a wait");
  if (!hvp_client_info_of(c->client)->interrupts) SKIP(c, "the driver polls");
  if (!case_begin_longest_job(c, &p)) return;
  // The system's numbers come through; one of the call-back's own is an interruption.
  static const int numbers[] = {-EINTR, -ECANCELED, -100000};
  static const int errors[] = {EINTR, ECANCELED, EINTR};
  for (int i = 0; i < 3; ++i) {
    c->board->interrupt_wait(c->board->context, numbers[i]);
    EXPECT_STATUS(c, hvp_client_wait(c->client, LONG_NS), HVP_ERROR_INTERRUPTED);
    EXPECT(c, errno == errors[i]);
  }
  is_over(c, &p);
}

static volatile sig_atomic_t signals;

static void count_signal(int number) {
  (void)number;
  ++signals;
}

// By a timer of a millisecond, which ends in the longest job.
static void interrupted_by_a_signal(struct suite_case* c) {
  struct problem p;
  if (hvp_client_descriptor(c->client) < 0) SKIP(c, "no system call waits here");
  if (!hvp_client_info_of(c->client)->interrupts) SKIP(c, "the driver polls");
  // Without SA_RESTART, so that the wait returns.
  struct sigaction before;
  struct sigaction action;
  memset(&action, 0, sizeof action);
  action.sa_handler = count_signal;
  EXPECT(c, sigaction(SIGALRM, &action, &before) == 0);
  const struct itimerval timer = {.it_value = {.tv_usec = 1000}};
  signals = 0;
  if (!case_begin_longest_job(c, &p)) return;
  EXPECT(c, setitimer(ITIMER_REAL, &timer, NULL) == 0);
  const hvp_status status = hvp_client_wait(c->client, LONG_NS);
  const int error = errno;
  const struct itimerval none = {.it_value = {.tv_usec = 0}};
  (void)setitimer(ITIMER_REAL, &none, NULL);
  (void)sigaction(SIGALRM, &before, NULL);
  if (status == HVP_OK && (signals == 0 || c->board->time_runs_on)) {
    SKIP(c, "the job ends before the signal tells here");
  }
  EXPECT_STATUS(c, status, HVP_ERROR_INTERRUPTED);
  EXPECT(c, error == EINTR);
  is_over(c, &p);
}

static void polled(struct suite_case* c) {
  struct problem p;
  const int descriptor = hvp_client_descriptor(c->client);
  if (descriptor < 0) SKIP(c, "there is no file to poll");
  if (!hvp_client_info_of(c->client)->interrupts) SKIP(c, "the driver polls");
  struct pollfd file = {.fd = descriptor, .events = POLLIN};
  problem_make(&p);
  if (!case_load(c, &p)) return;
  EXPECT(c, poll(&file, 1, 0) == 0);
  for (int job = 0; job < 3; ++job) {
    int32_t u[UNKNOWNS];
    EXPECT_OK(c, hvp_client_write_rhs(c->client, p.b, UNKNOWNS));
    EXPECT_OK(c, hvp_client_start(c->client));
    // An early one is possible, and taken away by the wait.
    hvp_status status = HVP_ERROR_TIMEOUT;
    for (int looks = 0; looks < 8 && status == HVP_ERROR_TIMEOUT; ++looks) {
      EXPECT(c, poll(&file, 1, 2000) == 1 && (file.revents & POLLIN) != 0);
      status = hvp_client_wait(c->client, 0U);
    }
    EXPECT_STATUS(c, status, HVP_OK);
    EXPECT(c, poll(&file, 1, 0) == 0);
    EXPECT_OK(c, hvp_client_read_solution(c->client, u, UNKNOWNS));
    EXPECT(c, problem_residual(&p, u) <= 4);
    case_hash(c, u, UNKNOWNS);
  }
}

// Who sleeps in poll() while another starts the job hears of its end.
static void polled_from_before(struct suite_case* c) {
  struct problem p;
  const int descriptor = hvp_client_descriptor(c->client);
  if (descriptor < 0) SKIP(c, "there is no file to poll");
  if (!hvp_client_info_of(c->client)->interrupts) SKIP(c, "the driver polls");
  problem_make(&p);
  if (!case_load(c, &p)) return;
  EXPECT_OK(c, hvp_client_write_rhs(c->client, p.b, UNKNOWNS));
  const pid_t sleeper = fork();
  EXPECT(c, sleeper >= 0);
  if (sleeper == 0) {
    // At its time-out poll() looks once more: who was never woken finds the end only then.
    struct timespec begin;
    struct timespec end;
    struct pollfd file = {.fd = descriptor, .events = POLLIN};
    (void)clock_gettime(CLOCK_MONOTONIC, &begin);
    const int found = poll(&file, 1, 5000);
    (void)clock_gettime(CLOCK_MONOTONIC, &end);
    _exit(found == 1 && (file.revents & POLLIN) != 0 && end.tv_sec - begin.tv_sec < 3 ? 0 : 1);
  }
  (void)usleep(20000);
  const hvp_status started = hvp_client_start(c->client);
  int ended = -1;
  EXPECT(c, waitpid(sleeper, &ended, 0) == sleeper);
  EXPECT_STATUS(c, started, HVP_OK);
  EXPECT(c, WIFEXITED(ended) && WEXITSTATUS(ended) == 0);
  EXPECT_OK(c, hvp_client_wait(c->client, LONG_NS));
}

static void nothing_is_lost(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  struct hvp_statistics statistics;
  struct hvp_statistics before;
  problem_make(&p);
  if (!case_load(c, &p)) return;
  EXPECT_OK(c, hvp_client_statistics(c->client, &before));
  for (int job = 0; job < 50; ++job) {
    if (!case_solve(c, &p, u)) return;
  }
  EXPECT_OK(c, hvp_client_statistics(c->client, &statistics));
  EXPECT(c, statistics.lost_interrupts == before.lost_interrupts);
  EXPECT(c, statistics.lost_acknowledgements == before.lost_acknowledgements);
}

const struct case_entry wait_cases[] = {
    {"wait-time-out", time_out},
    {"wait-no-time", no_time_at_all},
    {"wait-interrupted", interrupted_by_the_bus},
    {"wait-signal", interrupted_by_a_signal},
    {"wait-poll", polled},
    {"wait-poll-from-before", polled_from_before},
    {"reset-in-a-job", reset_ends_a_job},
    {"close-in-a-job", close_ends_a_job},
    {"fifty-jobs", nothing_is_lost},
    {NULL, NULL},
};
