#include <errno.h>
#include <poll.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <time.h>

#include "driver/linux/guest/servo_frames.h"
#include "driver/user/hvp_client.h"

// A servo loop as a program of Linux: at each tick it changes the matrix, sends b, starts the job,
// waits for it and reads U. It writes down what became of each frame.
//
// Ends with 0, with 1 where a frame failed, which is the last one then, with 2 for a wrong word or
// file, and with 3 where there is no board or no room.

#define NS_PER_S 1000000000U

struct loop {
  struct hvp_client* client;
  struct servo_frames frames;
  bool polls;
  uint64_t timeout_ns;
  int32_t* u;
  size_t n;
};

static uint64_t now_ns(void) {
  struct timespec now;
  (void)clock_gettime(CLOCK_MONOTONIC, &now);
  return (uint64_t)now.tv_sec * NS_PER_S + (uint64_t)now.tv_nsec;
}

static void sleep_until(uint64_t ns) {
  const struct timespec until = {.tv_sec = (time_t)(ns / NS_PER_S),
                                 .tv_nsec = (long)(ns % NS_PER_S)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL) == EINTR) continue;
}

// What makes a tick late that is not the board's: memory that is not there, others' programs, the
// 50 us by which the kernel may put timers together, and timers that go by the kernel's tick, as
// they do for a moment after it has started. Not every user may ask for all of it.
static void prepare(void) {
  const struct sched_param priority = {.sched_priority = 80};
  (void)mlockall(MCL_CURRENT);
  (void)sched_setscheduler(0, SCHED_FIFO, &priority);
  (void)prctl(PR_SET_TIMERSLACK, 1UL);
  struct timespec resolution = {0, 1};
  for (int tick = 0; tick < 100; ++tick) {
    (void)clock_getres(CLOCK_MONOTONIC, &resolution);
    if (resolution.tv_sec == 0 && resolution.tv_nsec <= 1000) return;
    sleep_until(now_ns() + 1000000U);
  }
  (void)fprintf(stderr, "hvp-servo: this kernel's timers go by its tick, of %ld ns\n",
                resolution.tv_nsec);
}

static hvp_status update(struct loop* loop) {
  hvp_status status = HVP_OK;
  for (uint32_t left = servo_take_updates(&loop->frames); left > 0U; --left) {
    const struct servo_update change = servo_take_update(&loop->frames);
    if (status != HVP_OK) continue;
    status = change.kind == SERVO_CONSTRAIN
                 ? hvp_client_constrain_node(loop->client, change.node, change.diagonal)
                 : hvp_client_restore_node(loop->client, change.node, change.values, change.blocks);
  }
  return status;
}

// By poll() the program could wait for more than the board.
static hvp_status await(const struct loop* loop) {
  struct pollfd board = {.fd = hvp_client_descriptor(loop->client), .events = POLLIN};
  if (loop->polls) (void)poll(&board, 1, (int)(loop->timeout_ns / 1000000U));
  return hvp_client_wait(loop->client, loop->timeout_ns);
}

static struct servo_record make_frame(struct loop* loop, uint64_t due) {
  sleep_until(due);
  struct servo_record record = {.due = due, .woken = now_ns()};
  hvp_status status = update(loop);
  const int32_t* b = servo_take_rhs(&loop->frames);
  if (status == HVP_OK) status = hvp_client_write_rhs(loop->client, b, loop->n);
  if (status == HVP_OK) status = hvp_client_start(loop->client);
  record.started = now_ns();
  if (status == HVP_OK) status = await(loop);
  record.ended = now_ns();
  record.flags = hvp_client_last_flags(loop->client);
  if (status == HVP_OK) status = hvp_client_read_solution(loop->client, loop->u, loop->n);
  record.read = now_ns();
  record.status = (uint32_t)status;
  return record;
}

static void complain(const char* what, hvp_status status) {
  (void)fprintf(stderr, "hvp-servo: %s: %s\n", what, hvp_status_text(status));
}

static int run(struct loop* loop, FILE* out) {
  const struct servo_frames* frames = &loop->frames;
  hvp_status status = hvp_client_configure(loop->client, &frames->config);
  if (status == HVP_OK) status = hvp_client_load_matrix(loop->client, &frames->matrix);
  if (status != HVP_OK) {
    complain("set-up", status);
    return 1;
  }
  bool written = servo_write_head(out, frames);
  const uint64_t first = now_ns() + frames->period_ns;
  for (uint32_t k = 0; k < frames->frames; ++k) {
    const struct servo_record record = make_frame(loop, first + k * frames->period_ns);
    written = written && servo_write_frame(out, &record, loop->u, loop->n);
    if (record.status != (uint32_t)HVP_OK) {
      char what[32];
      (void)snprintf(what, sizeof what, "frame %u", k);
      complain(what, (hvp_status)record.status);
      return 1;
    }
  }
  if (fflush(out) != 0) written = false;
  if (written) return 0;
  (void)fprintf(stderr, "hvp-servo: the output cannot be written\n");
  return 3;
}

static int usage(void) {
  (void)fprintf(stderr,
                "hvp-servo: expected hvp-servo BOARD FRAMES OUT [--poll] [--timeout-ms N], with N "
                "from 1 to 60000\n");
  return 2;
}

static bool parse_options(struct loop* loop, int argc, char** argv) {
  for (int i = 4; i < argc; ++i) {
    if (strcmp(argv[i], "--poll") == 0) {
      loop->polls = true;
    } else if (strcmp(argv[i], "--timeout-ms") == 0 && i + 1 < argc) {
      char* end = NULL;
      const long ms = strtol(argv[++i], &end, 10);
      if (end == argv[i] || *end != '\0' || ms < 1 || ms > 60000) return false;
      loop->timeout_ns = (uint64_t)ms * 1000000U;
    } else {
      return false;
    }
  }
  return true;
}

static int open_and_run(struct loop* loop, const char* board, const char* path) {
  const hvp_status status = hvp_client_open(&loop->client, board);
  if (status != HVP_OK) {
    complain(board, status);
    return 3;
  }
  FILE* out = fopen(path, "wb");
  int ended = 3;
  if (out == NULL) {
    (void)fprintf(stderr, "hvp-servo: %s: %s\n", path, strerror(errno));
  } else {
    ended = run(loop, out);
    if (fclose(out) != 0 && ended == 0) ended = 3;
  }
  (void)hvp_client_close(loop->client);
  return ended;
}

int main(int argc, char** argv) {
  struct loop loop = {.timeout_ns = 1000000000U};
  if (argc < 4 || !parse_options(&loop, argc, argv)) return usage();
  if (!servo_open_frames(&loop.frames, argv[2])) return 2;
  loop.n = (size_t)3 * loop.frames.matrix.nodes;
  loop.u = calloc(loop.n == 0U ? 1U : loop.n, sizeof *loop.u);
  int ended = 3;
  if (loop.u == NULL) {
    (void)fprintf(stderr, "hvp-servo: no room for U\n");
  } else {
    prepare();
    ended = open_and_run(&loop, argv[1], argv[3]);
  }
  free(loop.u);
  servo_close_frames(&loop.frames);
  return ended;
}
