// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#include <errno.h>
#include <stdlib.h>

#include "driver/hvp_errno.h"
#include "driver/user/client.h"

// The driver in the program, over the caller's call-backs.

// The longest b or U that the register map has room for: each is one burst, at any word length.
enum { SCRATCH_WORDS = 3 * 8192 };

struct bus_client {
  struct hvp_client client;
  struct hvp_device device;
  uint32_t scratch[SCRATCH_WORDS];
};

static struct bus_client* of(struct hvp_client* client) { return (struct bus_client*)client; }

// A wait_interrupt that gives up says why by one of the system's numbers, or by one of its own.
static hvp_status say(struct bus_client* bus, hvp_status status) {
  bus->client.detail = hvp_error_detail(&bus->device);
  bus->client.flags = hvp_last_flags(&bus->device);
  if (status == HVP_OK) return status;
  const int given = hvp_caller_error(&bus->device);
  const bool systems = status == HVP_ERROR_INTERRUPTED && given > -4096;
  return client_failed(status, systems ? -given : hvp_errno_of(status));
}

static hvp_status close_bus(struct hvp_client* client) {
  const hvp_status status = say(of(client), hvp_close(&of(client)->device));
  const int error = errno;
  free(client);
  errno = error;
  return status;
}

static hvp_status map_bus(struct hvp_client* client, struct hvp_client_memory* memory) {
  const struct hvp_device* device = &of(client)->device;
  const struct hvp_dma* dma = &device->dma;
  if (!device->uses_dma || dma->sync != NULL || dma->to_board_count != 1U ||
      dma->to_host_count != 1U) {
    return client_failed(HVP_ERROR_CAPABILITY, EOPNOTSUPP);
  }
  *memory = (struct hvp_client_memory){dma->to_board->memory, dma->to_board->bytes,
                                       dma->to_host->memory, dma->to_host->bytes};
  return HVP_OK;
}

static hvp_status use_dma_bus(struct hvp_client* client, const struct hvp_dma* dma) {
  const hvp_status status = hvp_use_dma(&of(client)->device, dma);
  if (status == HVP_OK) client->info.dma = dma != NULL;
  return say(of(client), status);
}

static hvp_status reset_bus(struct hvp_client* client) {
  return say(of(client), hvp_reset(&of(client)->device));
}

static hvp_status configure_bus(struct hvp_client* client, const struct hvp_solver_config* config) {
  return say(of(client), hvp_configure(&of(client)->device, config));
}

static hvp_status load_matrix_bus(struct hvp_client* client, const struct hvp_matrix* matrix) {
  return say(of(client), hvp_load_matrix(&of(client)->device, matrix));
}

static hvp_status constrain_node_bus(struct hvp_client* client, uint32_t node, int32_t diagonal) {
  return say(of(client), hvp_constrain_node(&of(client)->device, node, diagonal));
}

static hvp_status restore_node_bus(struct hvp_client* client, uint32_t node, const int32_t* values,
                                   uint32_t blocks) {
  return say(of(client), hvp_restore_node(&of(client)->device, node, values, blocks));
}

static hvp_status update_values_bus(struct hvp_client* client, const int32_t* values, size_t n,
                                    uint64_t timeout_ns) {
  return say(of(client), hvp_update_values(&of(client)->device, values, n, timeout_ns));
}

static hvp_status write_rhs_bus(struct hvp_client* client, const int32_t* b, size_t n) {
  return say(of(client), hvp_write_rhs(&of(client)->device, b, n));
}

static hvp_status write_initial_guess_bus(struct hvp_client* client, const int32_t* u, size_t n) {
  return say(of(client), hvp_write_initial_guess(&of(client)->device, u, n));
}

static hvp_status start_bus(struct hvp_client* client) {
  return say(of(client), hvp_start(&of(client)->device));
}

static hvp_status wait_bus(struct hvp_client* client, uint64_t timeout_ns) {
  return say(of(client), hvp_wait(&of(client)->device, timeout_ns));
}

static hvp_status read_solution_bus(struct hvp_client* client, int32_t* u, size_t n) {
  return say(of(client), hvp_read_solution(&of(client)->device, u, n));
}

static hvp_status read_result_bus(struct hvp_client* client, struct hvp_result* result) {
  return say(of(client), hvp_read_result(&of(client)->device, result));
}

static hvp_status solve_bus(struct hvp_client* client, const int32_t* b, int32_t* u, size_t n,
                            uint64_t timeout_ns) {
  return say(of(client), hvp_solve(&of(client)->device, b, u, n, timeout_ns));
}

static hvp_status statistics_bus(struct hvp_client* client, struct hvp_statistics* statistics) {
  *statistics = hvp_statistics_of(&of(client)->device);
  return HVP_OK;
}

static const struct client_calls bus_calls = {
    .close = close_bus,
    .map = map_bus,
    .use_dma = use_dma_bus,
    .reset = reset_bus,
    .configure = configure_bus,
    .load_matrix = load_matrix_bus,
    .constrain_node = constrain_node_bus,
    .restore_node = restore_node_bus,
    .update_values = update_values_bus,
    .write_rhs = write_rhs_bus,
    .write_initial_guess = write_initial_guess_bus,
    .start = start_bus,
    .wait = wait_bus,
    .read_solution = read_solution_bus,
    .read_result = read_result_bus,
    .solve = solve_bus,
    .statistics = statistics_bus,
};

hvp_status hvp_client_open_bus(struct hvp_client** client, const struct hvp_bus* bus) {
  if (client == NULL || bus == NULL) return client_failed(HVP_ERROR_ARGUMENT, EINVAL);
  *client = NULL;
  struct bus_client* made = calloc(1U, sizeof *made);
  if (made == NULL) return client_failed(HVP_ERROR_ARGUMENT, ENOMEM);
  const hvp_status status = hvp_open(&made->device, bus, made->scratch, SCRATCH_WORDS);
  if (status != HVP_OK) {
    free(made);
    return client_failed(status, hvp_errno_of(status));
  }
  made->client.calls = &bus_calls;
  made->client.descriptor = -1;
  made->client.capability = *hvp_capability_of(&made->device);
  made->client.info = (struct hvp_client_info){
      .interrupts = bus->wait_interrupt != NULL,
      .messages = bus->wait_interrupt != NULL && bus->interrupts_after_writes};
  *client = &made->client;
  return HVP_OK;
}
