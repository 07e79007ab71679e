#ifndef HVP_CLIENT_H
#define HVP_CLIENT_H

#include "driver/hvp_driver.h"

// The driver's calls for a program, whatever the board is behind: the device file of the kernel
// module, where the driver runs in the kernel, or a bus, where it runs in the program. A program
// that is written against this header runs on a board that a test scripts, on the virtual platform
// and in a Linux guest. POSIX; allocates what it needs.
//
// What a call does, and when it is allowed, driver/hvp_driver.h says under the same name. Each
// returns its hvp_status, and sets errno where that is not HVP_OK: to what driver/hvp_errno.h makes
// of it, or to what the system said. One thread uses a client.
#ifdef __cplusplus
extern "C" {
#endif

struct hvp_client;

// How the board is reached.
struct hvp_client_info {
  bool dma;                  // b and U go by the board's DMA engine
  bool interrupts;           // false: the driver polls
  bool messages;             // interrupts are messages, not a line
  uint32_t longest_wait_ms;  // a longer one is cut to it; 0: none is
};

// b and U as they lie in the memory of the DMA engine: little-endian, packed (FORMAT and PACKING in
// docs/registers.md). Null where there is none. Belongs to the client.
struct hvp_client_memory {
  uint32_t* rhs;
  size_t rhs_bytes;
  const uint32_t* solution;
  size_t solution_bytes;
};

// A board by its address: the path of a device file, beginning with a slash, or a scheme and what
// belongs to it. HVP_ERROR_ARGUMENT: no such scheme. HVP_ERROR_NO_DEVICE: nothing there, or no
// board; errno says what the system said. HVP_ERROR_STATE, EBUSY: another program has it.
hvp_status hvp_client_open(struct hvp_client** client, const char* address);
// The schemes, with a space between each two: "/dev/… vfio-user:…".
const char* hvp_client_schemes(void);

// A board behind call-backs, which are copied. Their context stays in use until hvp_client_close().
hvp_status hvp_client_open_bus(struct hvp_client** client, const struct hvp_bus* bus);
// As hvp_use_dma(), of a board behind call-backs only: HVP_ERROR_CAPABILITY elsewhere.
hvp_status hvp_client_use_dma(struct hvp_client* client, const struct hvp_dma* dma);
// Called by hvp_client_close() when the board is closed, instead of what was given before.
void hvp_client_at_close(struct hvp_client* client, void (*release)(void* context), void* context);

// The client is gone afterwards, whatever is returned. Null is allowed.
hvp_status hvp_client_close(struct hvp_client* client);

const struct hvp_client_info* hvp_client_info_of(const struct hvp_client* client);
const struct hvp_capability* hvp_client_capability(const struct hvp_client* client);
// Readable by poll() when a job has ended and nobody has waited for it; -1 where there is none. Not
// to be closed.
int hvp_client_descriptor(const struct hvp_client* client);
// HVP_ERROR_CAPABILITY: b and U do not go by DMA, or lie in several pieces. A program that writes b
// there starts without hvp_client_write_rhs(), and its words are not checked.
hvp_status hvp_client_map(struct hvp_client* client, struct hvp_client_memory* memory);

hvp_status hvp_client_reset(struct hvp_client* client);
hvp_status hvp_client_configure(struct hvp_client* client, const struct hvp_solver_config* config);
hvp_status hvp_client_load_matrix(struct hvp_client* client, const struct hvp_matrix* matrix);
hvp_status hvp_client_constrain_node(struct hvp_client* client, uint32_t node, int32_t diagonal);
hvp_status hvp_client_restore_node(struct hvp_client* client, uint32_t node, const int32_t* values,
                                   uint32_t blocks);
hvp_status hvp_client_write_rhs(struct hvp_client* client, const int32_t* b, size_t n);
hvp_status hvp_client_write_initial_guess(struct hvp_client* client, const int32_t* u, size_t n);
hvp_status hvp_client_start(struct hvp_client* client);
// A signal whose handler does not restart system calls ends it with HVP_ERROR_INTERRUPTED, EINTR,
// where the driver is in the kernel.
hvp_status hvp_client_wait(struct hvp_client* client, uint64_t timeout_ns);
hvp_status hvp_client_read_solution(struct hvp_client* client, int32_t* u, size_t n);
hvp_status hvp_client_read_result(struct hvp_client* client, struct hvp_result* result);
// HVP_ERROR_INTERRUPTED: the job goes on; hvp_client_wait(), then hvp_client_read_solution().
hvp_status hvp_client_solve(struct hvp_client* client, const int32_t* b, int32_t* u, size_t n,
                            uint64_t timeout_ns);

hvp_status hvp_client_statistics(struct hvp_client* client, struct hvp_statistics* statistics);
// Of the last call that reported an error of the board's, and of the last wait.
uint32_t hvp_client_error_detail(const struct hvp_client* client);
uint32_t hvp_client_last_flags(const struct hvp_client* client);

#ifdef __cplusplus
}
#endif

#endif
