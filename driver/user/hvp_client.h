// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#ifndef HVP_CLIENT_H
#define HVP_CLIENT_H

#include "driver/hvp_driver.h"

// The driver's calls for a program, for every connection of the board: the device file of the
// kernel module, with the driver in the kernel, or a bus, with the driver in the program. A program
// that is written against this header runs on a board that a test scripts, on the virtual platform
// and in a Linux guest. POSIX; allocates what it needs.
//
// driver/hvp_driver.h says under the same name what a call does and when it is allowed. Each
// returns its hvp_status and sets errno unless that is HVP_OK: to the number of driver/hvp_errno.h,
// or to the system's. One thread uses a client.
#ifdef __cplusplus
extern "C" {
#endif

struct hvp_client;

// The properties of the connection to the board.
struct hvp_client_info {
  bool dma;                  // b, U and new values of the matrix go by the board's DMA engine
  bool interrupts;           // false: the driver polls
  bool messages;             // interrupts are messages, not a line
  uint32_t longest_wait_ms;  // a longer one is cut to it; 0: none is
};

// b and U in the memory of the DMA engine: little-endian, packed (FORMAT and PACKING in
// docs/registers.md). Null without one. The memory is the client's.
struct hvp_client_memory {
  uint32_t* rhs;
  size_t rhs_bytes;
  const uint32_t* solution;
  size_t solution_bytes;
};

// Opens a board by its address: the path of a device file, beginning with a slash, or a scheme and
// its argument. HVP_ERROR_ARGUMENT: no such scheme. HVP_ERROR_NO_DEVICE: no board is there; errno
// is the system's. HVP_ERROR_STATE, EBUSY: another program has it.
hvp_status hvp_client_open(struct hvp_client** client, const char* address);
// The schemes, with a space between each two: "/dev/… vfio-user:…".
const char* hvp_client_schemes(void);

// Opens a board behind call-backs, which are copied. Their context stays in use until
// hvp_client_close().
hvp_status hvp_client_open_bus(struct hvp_client** client, const struct hvp_bus* bus);
// As hvp_use_dma(), for a board behind call-backs only; otherwise HVP_ERROR_CAPABILITY.
hvp_status hvp_client_use_dma(struct hvp_client* client, const struct hvp_dma* dma);
// `release` is called by hvp_client_close() when the board is closed, and replaces an earlier one.
void hvp_client_at_close(struct hvp_client* client, void (*release)(void* context), void* context);

// Frees the client, whatever is returned. Null is allowed.
hvp_status hvp_client_close(struct hvp_client* client);

const struct hvp_client_info* hvp_client_info_of(const struct hvp_client* client);
const struct hvp_capability* hvp_client_capability(const struct hvp_client* client);
// A descriptor that is readable for poll() when a job has ended and was not waited for; -1 if there
// is none. It must not be closed.
int hvp_client_descriptor(const struct hvp_client* client);
// Maps b and U. HVP_ERROR_CAPABILITY: they do not go by DMA, or are in several segments. A program
// that writes b there starts without hvp_client_write_rhs(), and its words are not checked.
hvp_status hvp_client_map(struct hvp_client* client, struct hvp_client_memory* memory);

hvp_status hvp_client_reset(struct hvp_client* client);
hvp_status hvp_client_configure(struct hvp_client* client, const struct hvp_solver_config* config);
hvp_status hvp_client_load_matrix(struct hvp_client* client, const struct hvp_matrix* matrix);
hvp_status hvp_client_constrain_node(struct hvp_client* client, uint32_t node, int32_t diagonal);
hvp_status hvp_client_restore_node(struct hvp_client* client, uint32_t node, const int32_t* values,
                                   uint32_t blocks);
hvp_status hvp_client_update_values(struct hvp_client* client, const int32_t* values, size_t n,
                                    uint64_t timeout_ns);
hvp_status hvp_client_write_rhs(struct hvp_client* client, const int32_t* b, size_t n);
hvp_status hvp_client_write_initial_guess(struct hvp_client* client, const int32_t* u, size_t n);
hvp_status hvp_client_start(struct hvp_client* client);
// A signal whose handler does not restart system calls ends it with HVP_ERROR_INTERRUPTED, EINTR,
// if the driver is in the kernel.
hvp_status hvp_client_wait(struct hvp_client* client, uint64_t timeout_ns);
hvp_status hvp_client_read_solution(struct hvp_client* client, int32_t* u, size_t n);
hvp_status hvp_client_read_result(struct hvp_client* client, struct hvp_result* result);
// HVP_ERROR_INTERRUPTED: the job goes on; hvp_client_wait(), then hvp_client_read_solution().
hvp_status hvp_client_solve(struct hvp_client* client, const int32_t* b, int32_t* u, size_t n,
                            uint64_t timeout_ns);

hvp_status hvp_client_statistics(struct hvp_client* client, struct hvp_statistics* statistics);
// The detail of the last error that the board reported, and the flags of the last wait.
uint32_t hvp_client_error_detail(const struct hvp_client* client);
uint32_t hvp_client_last_flags(const struct hvp_client* client);

#ifdef __cplusplus
}
#endif

#endif
