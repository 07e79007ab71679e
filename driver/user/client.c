// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#include "driver/user/client.h"

#include <errno.h>
#include <string.h>

#include "driver/hvp_errno.h"

struct scheme {
  const char* prefix;
  size_t kept;  // of the prefix, as a part of what is opened
  hvp_status (*open)(struct hvp_client** client, const char* rest);
};

static const struct scheme schemes[] = {
    {"/", 1U, client_open_file},
    {"vfio-user:", 0U, client_open_vfio_user},
};

const char* hvp_client_schemes(void) { return "/dev/… vfio-user:SOCKET"; }

hvp_status client_failed(hvp_status status, int error) {
  errno = error;
  return status;
}

hvp_status hvp_client_open(struct hvp_client** client, const char* address) {
  if (client == NULL || address == NULL) return client_failed(HVP_ERROR_ARGUMENT, EINVAL);
  *client = NULL;
  for (size_t i = 0; i < sizeof schemes / sizeof schemes[0]; ++i) {
    const size_t length = strlen(schemes[i].prefix);
    if (strncmp(address, schemes[i].prefix, length) != 0) continue;
    return schemes[i].open(client, address + length - schemes[i].kept);
  }
  return client_failed(HVP_ERROR_ARGUMENT, EINVAL);
}

void hvp_client_at_close(struct hvp_client* client, void (*release)(void* context), void* context) {
  if (client == NULL) return;
  client->release = release;
  client->release_context = context;
}

hvp_status hvp_client_close(struct hvp_client* client) {
  if (client == NULL) return HVP_OK;
  void (*const release)(void*) = client->release;
  void* const context = client->release_context;
  const hvp_status status = client->calls->close(client);
  const int error = errno;
  if (release != NULL) release(context);
  errno = error;
  return status;
}

const struct hvp_client_info* hvp_client_info_of(const struct hvp_client* client) {
  return client == NULL ? NULL : &client->info;
}

const struct hvp_capability* hvp_client_capability(const struct hvp_client* client) {
  return client == NULL ? NULL : &client->capability;
}

int hvp_client_descriptor(const struct hvp_client* client) {
  return client == NULL ? -1 : client->descriptor;
}

uint32_t hvp_client_error_detail(const struct hvp_client* client) {
  return client == NULL ? 0U : client->detail;
}

uint32_t hvp_client_last_flags(const struct hvp_client* client) {
  return client == NULL ? 0U : client->flags;
}

// Every call goes to its kind.
#define TO_KIND(call, ...)                                              \
  if (client == NULL) return client_failed(HVP_ERROR_ARGUMENT, EINVAL); \
  return client->calls->call(__VA_ARGS__)

hvp_status hvp_client_map(struct hvp_client* client, struct hvp_client_memory* memory) {
  if (memory == NULL) return client_failed(HVP_ERROR_ARGUMENT, EINVAL);
  TO_KIND(map, client, memory);
}

hvp_status hvp_client_use_dma(struct hvp_client* client, const struct hvp_dma* dma) {
  TO_KIND(use_dma, client, dma);
}

hvp_status hvp_client_reset(struct hvp_client* client) { TO_KIND(reset, client); }

hvp_status hvp_client_configure(struct hvp_client* client, const struct hvp_solver_config* config) {
  TO_KIND(configure, client, config);
}

hvp_status hvp_client_load_matrix(struct hvp_client* client, const struct hvp_matrix* matrix) {
  TO_KIND(load_matrix, client, matrix);
}

hvp_status hvp_client_constrain_node(struct hvp_client* client, uint32_t node, int32_t diagonal) {
  TO_KIND(constrain_node, client, node, diagonal);
}

hvp_status hvp_client_restore_node(struct hvp_client* client, uint32_t node, const int32_t* values,
                                   uint32_t blocks) {
  TO_KIND(restore_node, client, node, values, blocks);
}

hvp_status hvp_client_update_values(struct hvp_client* client, const int32_t* values, size_t n,
                                    uint64_t timeout_ns) {
  TO_KIND(update_values, client, values, n, timeout_ns);
}

hvp_status hvp_client_write_rhs(struct hvp_client* client, const int32_t* b, size_t n) {
  TO_KIND(write_rhs, client, b, n);
}

hvp_status hvp_client_write_initial_guess(struct hvp_client* client, const int32_t* u, size_t n) {
  TO_KIND(write_initial_guess, client, u, n);
}

hvp_status hvp_client_start(struct hvp_client* client) { TO_KIND(start, client); }

hvp_status hvp_client_wait(struct hvp_client* client, uint64_t timeout_ns) {
  TO_KIND(wait, client, timeout_ns);
}

hvp_status hvp_client_read_solution(struct hvp_client* client, int32_t* u, size_t n) {
  TO_KIND(read_solution, client, u, n);
}

hvp_status hvp_client_read_result(struct hvp_client* client, struct hvp_result* result) {
  TO_KIND(read_result, client, result);
}

hvp_status hvp_client_solve(struct hvp_client* client, const int32_t* b, int32_t* u, size_t n,
                            uint64_t timeout_ns) {
  TO_KIND(solve, client, b, u, n, timeout_ns);
}

hvp_status hvp_client_statistics(struct hvp_client* client, struct hvp_statistics* statistics) {
  if (statistics == NULL) return client_failed(HVP_ERROR_ARGUMENT, EINVAL);
  TO_KIND(statistics, client, statistics);
}
