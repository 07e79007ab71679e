#ifndef HVP_VFIO_USER_CLIENT_H
#define HVP_VFIO_USER_CLIENT_H

#include "driver/hvp_bus.h"

// The way of a program on Linux to a board that `hvp serve` models in another process: the
// call-backs of struct hvp_bus over a vfio-user socket (docs/vfio-user.md), memory that both
// processes share, and interrupts by an eventfd. Numbers that are returned are 0, or one of
// errno.h, negative. One thread owns a client.
#ifdef __cplusplus
extern "C" {
#endif

// A connection; the members are the client's own.
struct hvp_vfio_user {
  int socket;     // -1: none
  int interrupt;  // the eventfd
  uint16_t next_id;
  int error;                // what ended the connection; 0: it stands
  bool messages;            // interrupts are messages, else INTx
  bool masked;              // INTx was signalled and is masked since
  uint64_t bar_bytes;       // of the board's memory BAR
  uint64_t transfer_bytes;  // that the server takes in one message
};

// Connects, agrees on a version, and switches the function on: memory space, bus master and, where
// the board sends them, messages. -EBUSY: another client is served. -EPROTO: what answers is no
// board of a register map in memory BAR 0.
int hvp_vfio_user_open(struct hvp_vfio_user* client, const char* path);
void hvp_vfio_user_close(struct hvp_vfio_user* client);

// The call-backs; `client` stays where it is. After a failed connection reads give all ones, writes
// go nowhere, waits are HVP_INTERRUPT_BUS_FAILED and take_errors has HVP_BUS_MASTER_ABORT. now_ns
// is this machine's clock, not simulated time.
struct hvp_bus hvp_vfio_user_bus(struct hvp_vfio_user* client);

// `bytes` at an offset of the function's configuration space.
int hvp_vfio_user_read_config(struct hvp_vfio_user* client, uint32_t offset, void* data,
                              uint32_t bytes);
int hvp_vfio_user_write_config(struct hvp_vfio_user* client, uint32_t offset, const void* data,
                               uint32_t bytes);

// New memory, zero at first, that the board reaches at `bus_address`: whole pages. Its segments go
// into struct hvp_dma. Taken away by hvp_vfio_user_unshare() with the same address and bytes, which
// also works after the connection has failed.
int hvp_vfio_user_share(struct hvp_vfio_user* client, uint64_t bus_address, size_t bytes,
                        void** memory);
int hvp_vfio_user_unshare(struct hvp_vfio_user* client, uint64_t bus_address, size_t bytes,
                          void* memory);

// Memory of the caller's own: `bytes` of an open file from `offset` on, which the server maps.
int hvp_vfio_user_map(struct hvp_vfio_user* client, uint64_t bus_address, size_t bytes, int file,
                      uint64_t offset);
int hvp_vfio_user_unmap(struct hvp_vfio_user* client, uint64_t bus_address, size_t bytes);

// The board as after power-on, and switched on again.
int hvp_vfio_user_reset(struct hvp_vfio_user* client);

#ifdef __cplusplus
}
#endif

#endif
