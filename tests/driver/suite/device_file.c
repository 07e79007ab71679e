// A device file without a kernel: what the module does for driver/linux/hvp_ioctl.h, over a board
// in this process. The linker puts it in the place of the system's calls (CMakeLists.txt), so that
// the suite runs through the client library's file side and each structure goes both ways.
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "driver/hvp_errno.h"
#include "driver/linux/hvp_ioctl.h"
#include "tests/driver/suite/board_in_process.h"

static struct suite_board board;
static struct hvp_client* inner;

int __real_open(const char* path, int flags, ...);
int __real_close(int descriptor);
void* __real_mmap(void* at, size_t bytes, int protection, int flags, int descriptor, off_t offset);
int __real_munmap(void* at, size_t bytes);

static const char path_of_board[] = "/dev/hvp-double";
static int descriptor_of_board = -1;

int __wrap_open(const char* path, int flags, ...);
int __wrap_open(const char* path, int flags, ...) {
  if (strcmp(path, path_of_board) != 0) return __real_open(path, flags, 0);
  if (inner != NULL) {
    errno = EBUSY;
    return -1;
  }
  if (board.open(board.context, &inner) != HVP_OK) return -1;
  if (board.dma(board.context) != NULL) {
    (void)hvp_client_use_dma(inner, board.dma(board.context));
  }
  descriptor_of_board = __real_open("/dev/null", O_RDWR | O_CLOEXEC);
  return descriptor_of_board;
}

int __wrap_close(int descriptor);
int __wrap_close(int descriptor) {
  if (descriptor == descriptor_of_board && inner != NULL) {
    struct hvp_client_memory memory;
    // As the module does, the next program finds nothing.
    if (hvp_client_map(inner, &memory) == HVP_OK) {
      memset(memory.rhs, 0, memory.rhs_bytes);
      memset((void*)(uintptr_t)memory.solution, 0, memory.solution_bytes);
    }
    (void)hvp_client_close(inner);
    inner = NULL;
  }
  return __real_close(descriptor);
}

void* __wrap_mmap(void* at, size_t bytes, int protection, int flags, int descriptor, off_t offset);
void* __wrap_mmap(void* at, size_t bytes, int protection, int flags, int descriptor, off_t offset) {
  struct hvp_client_memory memory;
  if (descriptor < 0 || descriptor != descriptor_of_board) {
    return __real_mmap(at, bytes, protection, flags, descriptor, offset);
  }
  if (hvp_client_map(inner, &memory) != HVP_OK) return MAP_FAILED;
  if (offset == HVP_IOC_MAP_RHS && bytes == memory.rhs_bytes) return memory.rhs;
  if (offset == HVP_IOC_MAP_SOLUTION && bytes == memory.solution_bytes) {
    return (void*)(uintptr_t)memory.solution;
  }
  errno = EINVAL;
  return MAP_FAILED;
}

int __wrap_munmap(void* at, size_t bytes);
int __wrap_munmap(void* at, size_t bytes) {
  struct hvp_client_memory memory;
  if (inner != NULL && hvp_client_map(inner, &memory) == HVP_OK &&
      (at == memory.rhs || at == memory.solution)) {
    return 0;
  }
  return __real_munmap(at, bytes);
}

static const int32_t* elements(uint64_t address) { return (const int32_t*)(uintptr_t)address; }

static hvp_status inform(struct hvp_ioc_info* call) {
  const struct hvp_client_info* info = hvp_client_info_of(inner);
  const struct hvp_capability* capability = hvp_client_capability(inner);
  struct hvp_client_memory memory = {0};
  if (info->dma) (void)hvp_client_map(inner, &memory);
  *call = (struct hvp_ioc_info){.abi = HVP_IOC_ABI,
                                // The double's file is not one to poll().
                                .flags = HVP_IOC_F_POLLED | (info->dma ? HVP_IOC_F_DMA : 0U),
                                .max_nodes = capability->max_nodes,
                                .max_row_blocks = capability->max_row_blocks,
                                .max_blocks = capability->max_blocks,
                                .max_matrix_bits = capability->max_matrix_bits,
                                .max_vector_bits = capability->max_vector_bits,
                                .max_rhs_bits = capability->max_rhs_bits,
                                .max_coefficient_bits = capability->max_coefficient_bits,
                                .clock_khz = capability->clock_khz,
                                .methods = capability->methods,
                                .start_modes = capability->start_modes,
                                .max_scalar_bits = capability->max_scalar_bits,
                                .rhs_bytes = (uint32_t)memory.rhs_bytes,
                                .solution_bytes = (uint32_t)memory.solution_bytes};
  return HVP_OK;
}

static bool is_set(uint32_t flags, uint32_t flag) { return (flags & flag) != 0U; }

static hvp_status configure(const struct hvp_ioc_config* call) {
  const struct hvp_solver_config config = {
      .method = (hvp_method)call->method,
      .start = (hvp_start_from)call->start,
      .iterations = call->iterations,
      .stop_residual = call->stop_residual,
      .replace_every = call->replace_every,
      .static_shift = call->static_shift,
      .dynamic_scaling = is_set(call->flags, HVP_IOC_C_DYNAMIC_SCALING),
      .scaling_up_only = is_set(call->flags, HVP_IOC_C_SCALING_UP_ONLY),
      .headroom_bits = call->headroom_bits,
      .scaling_threshold = call->scaling_threshold,
      .scaling_step = call->scaling_step,
      .matrix_bits = call->matrix_bits,
      .vector_bits = call->vector_bits,
      .rhs_bits = call->rhs_bits,
      .scalar_bits = call->scalar_bits,
      .coefficient_bits = call->coefficient_bits,
      .fixed_coefficients = is_set(call->flags, HVP_IOC_C_FIXED_COEFFICIENTS),
      .alpha_fraction = call->alpha_fraction,
      .beta_fraction = call->beta_fraction,
      .division_rounding = (hvp_round)call->division_rounding,
      .shift_rounding = (hvp_round)call->shift_rounding,
      .one_a_word = is_set(call->flags, HVP_IOC_C_ONE_A_WORD),
      .wrap_overflow = is_set(call->flags, HVP_IOC_C_WRAP_OVERFLOW),
      .reject_saturated = is_set(call->flags, HVP_IOC_C_REJECT_SATURATED)};
  return hvp_client_configure(inner, &config);
}

static hvp_status load(const struct hvp_ioc_matrix* call) {
  const struct hvp_matrix matrix = {.nodes = call->nodes,
                                    .blocks = call->blocks,
                                    .row_begin = elements(call->row_begin),
                                    .column = elements(call->column),
                                    .value = elements(call->value)};
  return hvp_client_load_matrix(inner, &matrix);
}

static hvp_status read_result(struct hvp_ioc_result* call) {
  struct hvp_result result;
  const hvp_status status = hvp_client_read_result(inner, &result);
  if (status != HVP_OK) return status;
  *call = (struct hvp_ioc_result){.cycles = result.cycles,
                                  .job = result.job,
                                  .iterations = result.iterations,
                                  .reached = result.reached,
                                  .replacements = result.replacements,
                                  .saturations = result.saturations,
                                  .wraps = result.wraps,
                                  .breakdowns = result.breakdowns,
                                  .flags = result.flags};
  return HVP_OK;
}

static hvp_status vector(unsigned long request, const struct hvp_ioc_vector* call) {
  if (request == HVP_IOC_WRITE_RHS) {
    return hvp_client_write_rhs(inner, elements(call->elements), call->n);
  }
  if (request == HVP_IOC_WRITE_GUESS) {
    return hvp_client_write_initial_guess(inner, elements(call->elements), call->n);
  }
  return hvp_client_read_solution(inner, (int32_t*)(uintptr_t)call->elements, call->n);
}

static hvp_status wait_or_solve(unsigned long request, void* argument) {
  if (request == HVP_IOC_WAIT) {
    struct hvp_ioc_wait* call = argument;
    const hvp_status status = hvp_client_wait(inner, call->timeout_ns);
    call->flags = hvp_client_last_flags(inner);
    return status;
  }
  struct hvp_ioc_solve* call = argument;
  const hvp_status status = hvp_client_solve(
      inner, elements(call->rhs), (int32_t*)(uintptr_t)call->solution, call->n, call->timeout_ns);
  call->flags = hvp_client_last_flags(inner);
  return status;
}

static hvp_status node(unsigned long request, const void* argument) {
  if (request == HVP_IOC_CONSTRAIN) {
    const struct hvp_ioc_constraint* call = argument;
    return hvp_client_constrain_node(inner, call->node, call->diagonal);
  }
  const struct hvp_ioc_row* call = argument;
  return hvp_client_restore_node(inner, call->node, elements(call->values), call->blocks);
}

static hvp_status update_values(const struct hvp_ioc_values* call) {
  return hvp_client_update_values(inner, elements(call->values), call->n, call->timeout_ns);
}

static hvp_status count(struct hvp_ioc_statistics* call) {
  struct hvp_statistics statistics;
  (void)hvp_client_statistics(inner, &statistics);
  call->lost_interrupts = statistics.lost_interrupts;
  call->lost_acknowledgements = statistics.lost_acknowledgements;
  return HVP_OK;
}

static bool known(unsigned long request, void* argument, hvp_status* status) {
  switch (request) {
    case HVP_IOC_INFO:
      *status = inform(argument);
      return true;
    case HVP_IOC_RESET:
      *status = hvp_client_reset(inner);
      return true;
    case HVP_IOC_CONFIGURE:
      *status = configure(argument);
      return true;
    case HVP_IOC_LOAD:
      *status = load(argument);
      return true;
    case HVP_IOC_CONSTRAIN:
    case HVP_IOC_RESTORE:
      *status = node(request, argument);
      return true;
    case HVP_IOC_WRITE_RHS:
    case HVP_IOC_WRITE_GUESS:
    case HVP_IOC_READ_SOLUTION:
      *status = vector(request, argument);
      return true;
    case HVP_IOC_START:
      *status = hvp_client_start(inner);
      return true;
    case HVP_IOC_WAIT:
    case HVP_IOC_SOLVE:
      *status = wait_or_solve(request, argument);
      return true;
    case HVP_IOC_READ_RESULT:
      *status = read_result(argument);
      return true;
    case HVP_IOC_UPDATE:
      *status = update_values(argument);
      return true;
    case HVP_IOC_STATISTICS:
      *status = count(argument);
      return true;
    default:
      return false;
  }
}

int __wrap_ioctl(int descriptor, unsigned long request, ...);
int __wrap_ioctl(int descriptor, unsigned long request, ...) {
  va_list arguments;
  va_start(arguments, request);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  hvp_status status;
  if (descriptor != descriptor_of_board || !known(request, argument, &status)) {
    errno = ENOTTY;
    return -1;
  }
  struct hvp_ioc_head* head = argument;
  head->status = (uint32_t)status;
  head->detail = hvp_client_error_detail(inner);
  if (status == HVP_OK) return 0;
  errno = hvp_errno_of(status);
  return -1;
}

static hvp_status open_file(void* context, struct hvp_client** client) {
  (void)context;
  return hvp_client_open(client, path_of_board);
}

int main(int argc, char** argv) {
  const int used = board_in_process(&board, argc - 1, argv + 1);
  if (used == 0) return 2;
  struct suite_board file = board;
  file.open = open_file;
  // A list that the module made is out of a program's reach.
  file.dma = NULL;
  const int status = suite_main(&file, argc - 1 - used, argv + 1 + used);
  board_in_process_close();
  return status;
}
