// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#ifndef HVP_USER_CLIENT_H
#define HVP_USER_CLIENT_H

#include "driver/user/hvp_client.h"

// The declarations that the kinds of clients share, for the library only.

// The calls of one kind of client. Each stores `detail` and `flags`. `close` frees the client.
struct client_calls {
  hvp_status (*close)(struct hvp_client* client);
  hvp_status (*map)(struct hvp_client* client, struct hvp_client_memory* memory);
  hvp_status (*use_dma)(struct hvp_client* client, const struct hvp_dma* dma);
  hvp_status (*reset)(struct hvp_client* client);
  hvp_status (*configure)(struct hvp_client* client, const struct hvp_solver_config* config);
  hvp_status (*load_matrix)(struct hvp_client* client, const struct hvp_matrix* matrix);
  hvp_status (*constrain_node)(struct hvp_client* client, uint32_t node, int32_t diagonal);
  hvp_status (*restore_node)(struct hvp_client* client, uint32_t node, const int32_t* values,
                             uint32_t blocks);
  hvp_status (*update_values)(struct hvp_client* client, const int32_t* values, size_t n,
                              uint64_t timeout_ns);
  hvp_status (*write_rhs)(struct hvp_client* client, const int32_t* b, size_t n);
  hvp_status (*write_initial_guess)(struct hvp_client* client, const int32_t* u, size_t n);
  hvp_status (*start)(struct hvp_client* client);
  hvp_status (*wait)(struct hvp_client* client, uint64_t timeout_ns);
  hvp_status (*read_solution)(struct hvp_client* client, int32_t* u, size_t n);
  hvp_status (*read_result)(struct hvp_client* client, struct hvp_result* result);
  hvp_status (*solve)(struct hvp_client* client, const int32_t* b, int32_t* u, size_t n,
                      uint64_t timeout_ns);
  hvp_status (*statistics)(struct hvp_client* client, struct hvp_statistics* statistics);
};

struct hvp_client {
  const struct client_calls* calls;
  struct hvp_client_info info;
  struct hvp_capability capability;
  int descriptor;
  uint32_t detail;
  uint32_t flags;
  void (*release)(void* context);
  void* release_context;
};

// The kinds, by what stands behind an address' scheme.
hvp_status client_open_file(struct hvp_client** client, const char* path);
hvp_status client_open_vfio_user(struct hvp_client** client, const char* path);

// Sets errno for the status, and returns the status.
hvp_status client_failed(hvp_status status, int error);

#endif
