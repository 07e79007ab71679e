// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "driver/hvp_errno.h"
#include "driver/linux/hvp_ioctl.h"
#include "driver/user/client.h"

// The driver in the kernel, through the module's device file.

struct file_client {
  struct hvp_client client;
  uint32_t rhs_bytes;  // of the memory that may be mapped
  uint32_t solution_bytes;
  struct hvp_client_memory memory;  // mapped, or all null
};

static struct file_client* of(struct hvp_client* client) { return (struct file_client*)client; }

static uint64_t address_of(const void* memory) { return (uint64_t)(uintptr_t)memory; }

// The system's own refusals, in which no driver had a say.
static hvp_status status_of_error(int error) {
  switch (error) {
    case EINTR:
      return HVP_ERROR_INTERRUPTED;
    case EINVAL:
    case EFAULT:
    case ENOMEM:
      return HVP_ERROR_ARGUMENT;
    case EBUSY:
      return HVP_ERROR_STATE;
    case EIO:
      return HVP_ERROR_BUS;
    default:
      return HVP_ERROR_NO_DEVICE;
  }
}

// `call` is a structure that begins with `head`.
static hvp_status ask(struct hvp_client* client, unsigned long request, struct hvp_ioc_head* head,
                      void* call) {
  head->status = HVP_IOC_UNTOUCHED;
  const int outcome = ioctl(client->descriptor, request, call);
  if (head->status != HVP_IOC_UNTOUCHED) client->detail = head->detail;
  if (outcome == 0) return HVP_OK;
  if (head->status == HVP_IOC_UNTOUCHED || head->status == (uint32_t)HVP_OK) {
    return status_of_error(errno);
  }
  return (hvp_status)head->status;
}

static hvp_status missing(void) { return client_failed(HVP_ERROR_ARGUMENT, EINVAL); }

static hvp_status close_file(struct hvp_client* client) {
  const struct hvp_client_memory* memory = &of(client)->memory;
  if (memory->rhs != NULL) (void)munmap(memory->rhs, memory->rhs_bytes);
  // What is read only is unmapped like the rest.
  if (memory->solution != NULL) (void)munmap((void*)memory->solution, memory->solution_bytes);
  const int outcome = close(client->descriptor);
  const int error = errno;
  free(client);
  return outcome == 0 ? HVP_OK : client_failed(HVP_ERROR_BUS, error);
}

static hvp_status map_file(struct hvp_client* client, struct hvp_client_memory* memory) {
  struct file_client* file = of(client);
  if (!client->info.dma) return client_failed(HVP_ERROR_CAPABILITY, EOPNOTSUPP);
  if (file->memory.rhs == NULL) {
    void* rhs = mmap(NULL, file->rhs_bytes, PROT_READ | PROT_WRITE, MAP_SHARED, client->descriptor,
                     (off_t)HVP_IOC_MAP_RHS);
    if (rhs == MAP_FAILED) return status_of_error(errno);
    void* solution = mmap(NULL, file->solution_bytes, PROT_READ, MAP_SHARED, client->descriptor,
                          (off_t)HVP_IOC_MAP_SOLUTION);
    if (solution == MAP_FAILED) {
      const int error = errno;
      (void)munmap(rhs, file->rhs_bytes);
      return client_failed(status_of_error(error), error);
    }
    file->memory = (struct hvp_client_memory){rhs, file->rhs_bytes, solution, file->solution_bytes};
  }
  *memory = file->memory;
  return HVP_OK;
}

static hvp_status use_dma_file(struct hvp_client* client, const struct hvp_dma* dma) {
  (void)client;
  (void)dma;
  return client_failed(HVP_ERROR_CAPABILITY, EOPNOTSUPP);
}

static hvp_status reset_file(struct hvp_client* client) {
  struct hvp_ioc_head call = {0U, 0U};
  return ask(client, HVP_IOC_RESET, &call, &call);
}

static uint32_t flag(bool set, uint32_t value) { return set ? value : 0U; }

static hvp_status configure_file(struct hvp_client* client,
                                 const struct hvp_solver_config* config) {
  if (config == NULL) return missing();
  struct hvp_ioc_config call = {
      .stop_residual = config->stop_residual,
      .flags = flag(config->dynamic_scaling, HVP_IOC_C_DYNAMIC_SCALING) |
               flag(config->scaling_up_only, HVP_IOC_C_SCALING_UP_ONLY) |
               flag(config->fixed_coefficients, HVP_IOC_C_FIXED_COEFFICIENTS) |
               flag(config->one_a_word, HVP_IOC_C_ONE_A_WORD) |
               flag(config->wrap_overflow, HVP_IOC_C_WRAP_OVERFLOW) |
               flag(config->reject_saturated, HVP_IOC_C_REJECT_SATURATED),
      .method = (uint32_t)config->method,
      .start = (uint32_t)config->start,
      .iterations = config->iterations,
      .replace_every = config->replace_every,
      .static_shift = config->static_shift,
      .headroom_bits = config->headroom_bits,
      .scaling_threshold = config->scaling_threshold,
      .scaling_step = config->scaling_step,
      .matrix_bits = config->matrix_bits,
      .vector_bits = config->vector_bits,
      .rhs_bits = config->rhs_bits,
      .scalar_bits = config->scalar_bits,
      .coefficient_bits = config->coefficient_bits,
      .alpha_fraction = config->alpha_fraction,
      .beta_fraction = config->beta_fraction,
      .division_rounding = (uint32_t)config->division_rounding,
      .shift_rounding = (uint32_t)config->shift_rounding};
  return ask(client, HVP_IOC_CONFIGURE, &call.head, &call);
}

static hvp_status load_matrix_file(struct hvp_client* client, const struct hvp_matrix* matrix) {
  if (matrix == NULL) return missing();
  struct hvp_ioc_matrix call = {.nodes = matrix->nodes,
                                .blocks = matrix->blocks,
                                .row_begin = address_of(matrix->row_begin),
                                .column = address_of(matrix->column),
                                .value = address_of(matrix->value)};
  return ask(client, HVP_IOC_LOAD, &call.head, &call);
}

static hvp_status constrain_node_file(struct hvp_client* client, uint32_t node, int32_t diagonal) {
  struct hvp_ioc_constraint call = {.node = node, .diagonal = diagonal};
  return ask(client, HVP_IOC_CONSTRAIN, &call.head, &call);
}

static hvp_status restore_node_file(struct hvp_client* client, uint32_t node, const int32_t* values,
                                    uint32_t blocks) {
  struct hvp_ioc_row call = {.node = node, .blocks = blocks, .values = address_of(values)};
  return ask(client, HVP_IOC_RESTORE, &call.head, &call);
}

static hvp_status update_values_file(struct hvp_client* client, const int32_t* values, size_t n,
                                     uint64_t timeout_ns) {
  if (n > UINT32_MAX) return missing();
  struct hvp_ioc_values call = {
      .values = address_of(values), .timeout_ns = timeout_ns, .n = (uint32_t)n};
  return ask(client, HVP_IOC_UPDATE, &call.head, &call);
}

static hvp_status send_vector(struct hvp_client* client, unsigned long request,
                              const int32_t* elements, size_t n) {
  if (n > UINT32_MAX) return missing();
  struct hvp_ioc_vector call = {.elements = address_of(elements), .n = (uint32_t)n};
  return ask(client, request, &call.head, &call);
}

static hvp_status write_rhs_file(struct hvp_client* client, const int32_t* b, size_t n) {
  return send_vector(client, HVP_IOC_WRITE_RHS, b, n);
}

static hvp_status write_initial_guess_file(struct hvp_client* client, const int32_t* u, size_t n) {
  return send_vector(client, HVP_IOC_WRITE_GUESS, u, n);
}

static hvp_status start_file(struct hvp_client* client) {
  struct hvp_ioc_head call = {0U, 0U};
  return ask(client, HVP_IOC_START, &call, &call);
}

static hvp_status wait_file(struct hvp_client* client, uint64_t timeout_ns) {
  struct hvp_ioc_wait call = {.timeout_ns = timeout_ns};
  const hvp_status status = ask(client, HVP_IOC_WAIT, &call.head, &call);
  if (status == HVP_OK || status == HVP_ERROR_SATURATED) client->flags = call.flags;
  return status;
}

static hvp_status read_solution_file(struct hvp_client* client, int32_t* u, size_t n) {
  return send_vector(client, HVP_IOC_READ_SOLUTION, u, n);
}

static hvp_status read_result_file(struct hvp_client* client, struct hvp_result* result) {
  if (result == NULL) return missing();
  struct hvp_ioc_result call = {.cycles = 0U};
  const hvp_status status = ask(client, HVP_IOC_READ_RESULT, &call.head, &call);
  if (status != HVP_OK) return status;
  *result = (struct hvp_result){.job = call.job,
                                .iterations = call.iterations,
                                .reached = call.reached != 0U,
                                .replacements = call.replacements,
                                .saturations = call.saturations,
                                .wraps = call.wraps,
                                .breakdowns = call.breakdowns,
                                .flags = call.flags,
                                .cycles = call.cycles};
  return HVP_OK;
}

static hvp_status solve_file(struct hvp_client* client, const int32_t* b, int32_t* u, size_t n,
                             uint64_t timeout_ns) {
  if (n > UINT32_MAX) return missing();
  struct hvp_ioc_solve call = {
      .rhs = address_of(b), .solution = address_of(u), .timeout_ns = timeout_ns, .n = (uint32_t)n};
  const hvp_status status = ask(client, HVP_IOC_SOLVE, &call.head, &call);
  if (status == HVP_OK || status == HVP_ERROR_SATURATED) client->flags = call.flags;
  return status;
}

static hvp_status statistics_file(struct hvp_client* client, struct hvp_statistics* statistics) {
  struct hvp_ioc_statistics call = {.jobs = 0U};
  const hvp_status status = ask(client, HVP_IOC_STATISTICS, &call.head, &call);
  if (status == HVP_OK) {
    *statistics = (struct hvp_statistics){.lost_interrupts = call.lost_interrupts,
                                          .lost_acknowledgements = call.lost_acknowledgements};
  }
  return status;
}

static const struct client_calls file_calls = {
    .close = close_file,
    .map = map_file,
    .use_dma = use_dma_file,
    .reset = reset_file,
    .configure = configure_file,
    .load_matrix = load_matrix_file,
    .constrain_node = constrain_node_file,
    .restore_node = restore_node_file,
    .update_values = update_values_file,
    .write_rhs = write_rhs_file,
    .write_initial_guess = write_initial_guess_file,
    .start = start_file,
    .wait = wait_file,
    .read_solution = read_solution_file,
    .read_result = read_result_file,
    .solve = solve_file,
    .statistics = statistics_file,
};

static hvp_status learn(struct file_client* file) {
  struct hvp_ioc_info call = {.abi = 0U};
  const hvp_status status = ask(&file->client, HVP_IOC_INFO, &call.head, &call);
  if (status != HVP_OK) return status;
  if (call.abi != HVP_IOC_ABI) return client_failed(HVP_ERROR_VERSION, EPROTONOSUPPORT);
  file->client.info = (struct hvp_client_info){.dma = (call.flags & HVP_IOC_F_DMA) != 0U,
                                               .interrupts = (call.flags & HVP_IOC_F_POLLED) == 0U,
                                               .messages = (call.flags & HVP_IOC_F_MSI) != 0U,
                                               .longest_wait_ms = call.max_timeout_ms};
  file->client.capability =
      (struct hvp_capability){.max_nodes = call.max_nodes,
                              .max_row_blocks = call.max_row_blocks,
                              .max_blocks = call.max_blocks,
                              .max_matrix_bits = call.max_matrix_bits,
                              .max_vector_bits = call.max_vector_bits,
                              .max_rhs_bits = call.max_rhs_bits,
                              .max_coefficient_bits = call.max_coefficient_bits,
                              .clock_khz = call.clock_khz,
                              .methods = call.methods,
                              .start_modes = call.start_modes,
                              .max_scalar_bits = call.max_scalar_bits};
  file->rhs_bytes = call.rhs_bytes;
  file->solution_bytes = call.solution_bytes;
  return HVP_OK;
}

hvp_status client_open_file(struct hvp_client** client, const char* path) {
  struct file_client* made = calloc(1U, sizeof *made);
  if (made == NULL) return client_failed(HVP_ERROR_ARGUMENT, ENOMEM);
  made->client.calls = &file_calls;
  made->client.descriptor = open(path, O_RDWR | O_CLOEXEC);
  if (made->client.descriptor < 0) {
    const int error = errno;
    free(made);
    return client_failed(status_of_error(error), error);
  }
  const hvp_status status = learn(made);
  if (status != HVP_OK) {
    const int error = errno;
    (void)close_file(&made->client);
    return client_failed(status, error);
  }
  *client = &made->client;
  return HVP_OK;
}
