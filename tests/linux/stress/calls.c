#include "tests/linux/stress/calls.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

static uint64_t address_of(const void* memory) { return (uint64_t)(uintptr_t)memory; }

static hvp_status ask(struct stress_worker* worker, enum stress_operation operation,
                      unsigned long request, struct hvp_ioc_head* head, void* call) {
  head->status = HVP_IOC_UNTOUCHED;
  const unsigned before = stress_signals();
  stress_begin(worker, operation);
  const int outcome = ioctl(atomic_load(&worker->stress->descriptor), request, call);
  const int error = errno;
  stress_end(worker);
  return stress_judge(worker, operation, head, outcome, error, stress_signals() != before);
}

// A descriptor that no other file of the program gets when another thread has closed it.
enum { FIRST_DESCRIPTOR = 100 };

void stress_open(struct stress_worker* worker) {
  static const int may[] = {ENOENT, ENODEV, ENXIO, EBUSY, EINTR, 0};
  struct stress* stress = worker->stress;
  stress_begin(worker, STRESS_OPEN);
  const int opened = open(stress->board, O_RDWR | O_CLOEXEC);
  const int error = opened < 0 ? errno : 0;
  stress_end(worker);
  if (!stress_judge_error(worker, STRESS_OPEN, error, may)) return;
  int found = -1;
  const int moved = fcntl(opened, F_DUPFD_CLOEXEC, FIRST_DESCRIPTOR);
  (void)close(opened);
  // Another thread's file may wait to be let go by a call.
  if (!atomic_compare_exchange_strong(&stress->descriptor, &found, moved)) (void)close(moved);
}

void stress_close(struct stress_worker* worker) {
  static const int none[] = {0};
  const int descriptor = atomic_exchange(&worker->stress->descriptor, -1);
  if (descriptor < 0) return;
  stress_begin(worker, STRESS_CLOSE);
  const int error = close(descriptor) == 0 ? 0 : errno;
  stress_end(worker);
  (void)stress_judge_error(worker, STRESS_CLOSE, error, none);
}

hvp_status stress_info(struct stress_worker* worker, struct hvp_ioc_info* info) {
  return ask(worker, STRESS_INFO, HVP_IOC_INFO, &info->head, info);
}

hvp_status stress_statistics(struct stress_worker* worker) {
  struct hvp_ioc_statistics call = {.jobs = 0U};
  return ask(worker, STRESS_STATISTICS, HVP_IOC_STATISTICS, &call.head, &call);
}

hvp_status stress_reset(struct stress_worker* worker) {
  struct hvp_ioc_head call = {0U, 0U};
  return ask(worker, STRESS_RESET, HVP_IOC_RESET, &call, &call);
}

hvp_status stress_configure(struct stress_worker* worker) {
  const struct hvp_solver_config config = stress_config(stress_draw(worker, STRESS_LENGTHS));
  struct hvp_ioc_config call = {.flags = HVP_IOC_C_DYNAMIC_SCALING | HVP_IOC_C_REJECT_SATURATED,
                                .method = (uint32_t)config.method,
                                .start = (uint32_t)config.start,
                                .iterations = config.iterations,
                                .static_shift = config.static_shift,
                                .headroom_bits = config.headroom_bits,
                                .matrix_bits = config.matrix_bits,
                                .vector_bits = config.vector_bits,
                                .coefficient_bits = config.coefficient_bits};
  return ask(worker, STRESS_CONFIGURE, HVP_IOC_CONFIGURE, &call.head, &call);
}

hvp_status stress_load(struct stress_worker* worker) {
  const struct problem* problem = &worker->stress->references.problem;
  struct hvp_ioc_matrix call = {.nodes = NODES,
                                .blocks = BLOCKS,
                                .row_begin = address_of(problem->row_begin),
                                .column = address_of(problem->column),
                                .value = address_of(problem->value)};
  return ask(worker, STRESS_LOAD, HVP_IOC_LOAD, &call.head, &call);
}

hvp_status stress_constrain(struct stress_worker* worker) {
  struct hvp_ioc_constraint call = {.node = STRESS_HELD_NODE, .diagonal = STRESS_DIAGONAL};
  return ask(worker, STRESS_CONSTRAIN, HVP_IOC_CONSTRAIN, &call.head, &call);
}

hvp_status stress_restore(struct stress_worker* worker) {
  const struct problem* problem = &worker->stress->references.problem;
  const int32_t begin = problem->row_begin[STRESS_HELD_NODE];
  const uint32_t blocks = (uint32_t)(problem->row_begin[STRESS_HELD_NODE + 1] - begin);
  struct hvp_ioc_row call = {
      .node = STRESS_HELD_NODE, .blocks = blocks, .values = address_of(&problem->value[9 * begin])};
  return ask(worker, STRESS_RESTORE, HVP_IOC_RESTORE, &call.head, &call);
}

hvp_status stress_write(struct stress_worker* worker, enum stress_operation operation,
                        unsigned rhs) {
  struct hvp_ioc_vector call = {.elements = address_of(worker->stress->references.b[rhs]),
                                .n = UNKNOWNS};
  const unsigned long request =
      operation == STRESS_WRITE_GUESS ? HVP_IOC_WRITE_GUESS : HVP_IOC_WRITE_RHS;
  return ask(worker, operation, request, &call.head, &call);
}

hvp_status stress_start(struct stress_worker* worker) {
  struct hvp_ioc_head call = {0U, 0U};
  return ask(worker, STRESS_START, HVP_IOC_START, &call, &call);
}

hvp_status stress_wait(struct stress_worker* worker, uint64_t timeout_ns) {
  struct hvp_ioc_wait call = {.timeout_ns = timeout_ns};
  return ask(worker, STRESS_WAIT, HVP_IOC_WAIT, &call.head, &call);
}

bool stress_poll(struct stress_worker* worker, int timeout_ms) {
  struct pollfd board = {.fd = atomic_load(&worker->stress->descriptor), .events = POLLIN};
  stress_begin(worker, STRESS_POLL);
  const int outcome = poll(&board, 1, timeout_ms);
  const int error = errno;
  stress_end(worker);
  if (outcome < 0) {
    stress_count(STRESS_POLL, error == EINTR ? "EINTR" : "failed");
    if (error != EINTR) stress_fail(worker->stress, "poll: errno %d", error);
    return true;
  }
  stress_count(STRESS_POLL, outcome == 0                      ? "nothing"
                            : (board.revents & POLLNVAL) != 0 ? "closed"
                            : (board.revents & POLLHUP) != 0  ? "gone"
                            : board.revents == POLLIN         ? "readable"
                                                              : "another event");
  return outcome > 0;
}

hvp_status stress_read_solution(struct stress_worker* worker, int32_t* u) {
  struct hvp_ioc_vector call = {.elements = address_of(u), .n = UNKNOWNS};
  return ask(worker, STRESS_READ_SOLUTION, HVP_IOC_READ_SOLUTION, &call.head, &call);
}

hvp_status stress_read_result(struct stress_worker* worker) {
  struct hvp_ioc_result call = {.job = 0U};
  return ask(worker, STRESS_READ_RESULT, HVP_IOC_READ_RESULT, &call.head, &call);
}

hvp_status stress_solve(struct stress_worker* worker, unsigned rhs, uint64_t timeout_ns,
                        int32_t* u) {
  struct hvp_ioc_solve call = {.rhs = address_of(worker->stress->references.b[rhs]),
                               .solution = address_of(u),
                               .timeout_ns = timeout_ns,
                               .n = UNKNOWNS};
  return ask(worker, STRESS_SOLVE, HVP_IOC_SOLVE, &call.head, &call);
}

void stress_ask_wrongly(struct stress_worker* worker) {
  static const int may[] = {ENOTTY, EFAULT, EINVAL,     EBADF, EBADFD,
                            EIO,    ENODEV, EOPNOTSUPP, EINTR, 0};
  struct hvp_ioc_head head = {0U, 0U};
  struct hvp_ioc_vector vector = {.elements = 8U, .n = UNKNOWNS};
  struct hvp_ioc_matrix matrix = {.nodes = NODES, .blocks = BLOCKS, .row_begin = 8U};
  unsigned long request = HVP_IOC_WRITE_RHS;
  void* call = &vector;
  switch (stress_draw(worker, 6U)) {
    case 0:
      request = _IO(HVP_IOC_MAGIC, 0x7f);
      call = &head;
      break;
    case 1:  // a structure that is not there
      call = NULL;
      break;
    case 2:  // words that are not there
      break;
    case 3:
      vector.pad = 1U;
      break;
    case 4:  // more than a board has, or a number of bytes that 32 bits do not hold
      vector.n = stress_draw(worker, 2U) == 0U ? 0x40000001U : 0xffffffffU;
      break;
    default:
      request = HVP_IOC_LOAD;
      call = &matrix;
      break;
  }
  stress_begin(worker, STRESS_WRONG);
  const int outcome = ioctl(atomic_load(&worker->stress->descriptor), request, call);
  const int error = outcome == 0 ? 0 : errno;
  stress_end(worker);
  if (stress_judge_error(worker, STRESS_WRONG, error, may)) {
    stress_fail(worker->stress, "a wrong call 0x%lx is taken", request);
  }
}

void stress_read_attribute(struct stress_worker* worker) {
  static const char* const files[] = {"statistics/jobs", "statistics/last_error",
                                      "statistics/interrupts", "capability/dma",
                                      "capability/interrupt"};
  static const int may[] = {ENOENT, ENODEV, EINTR, 0};
  char path[256];
  char text[64];
  (void)snprintf(path, sizeof path, "%s/%s", worker->stress->attributes,
                 files[stress_draw(worker, sizeof files / sizeof *files)]);
  stress_begin(worker, STRESS_ATTRIBUTE);
  const int file = open(path, O_RDONLY | O_CLOEXEC);
  const int error = file < 0 || read(file, text, sizeof text) < 0 ? errno : 0;
  if (file >= 0) (void)close(file);
  stress_end(worker);
  (void)stress_judge_error(worker, STRESS_ATTRIBUTE, error, may);
}

void* stress_map(struct stress_worker* worker, uint32_t which, size_t bytes) {
  static const int may[] = {ENODEV, EBADF, 0};
  const int access = which == HVP_IOC_MAP_RHS ? PROT_READ | PROT_WRITE : PROT_READ;
  stress_begin(worker, STRESS_MAP);
  void* memory =
      mmap(NULL, bytes, access, MAP_SHARED, atomic_load(&worker->stress->descriptor), (off_t)which);
  const int error = memory == MAP_FAILED ? errno : 0;
  stress_end(worker);
  return stress_judge_error(worker, STRESS_MAP, error, may) ? memory : NULL;
}
