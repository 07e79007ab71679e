// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#ifndef HVP_VFIO_USER_CLIENT_H
#define HVP_VFIO_USER_CLIENT_H

#include "driver/hvp_bus.h"

// A connection from a program on Linux to a board that `hvp serve` models in another process: the
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
  int error;                // the error that ended the connection; 0: it is open
  bool messages;            // interrupts are messages, else INTx
  bool masked;              // INTx was signalled and has been masked since
  uint64_t bar_bytes;       // size of the board's memory BAR
  uint64_t transfer_bytes;  // the most that the server takes in one message
};

// Connects, agrees on a version, and switches the function on: memory space, bus master and, where
// the board sends them, messages. -EBUSY: another client is served. -EPROTO: the server's device is
// not a board with a register map in memory BAR 0.
int hvp_vfio_user_open(struct hvp_vfio_user* client, const char* path);
void hvp_vfio_user_close(struct hvp_vfio_user* client);

// The call-backs of a client, which has to stay in place. After a failed connection reads give all
// ones, writes have no effect, waits return HVP_INTERRUPT_BUS_FAILED and take_errors returns
// HVP_BUS_MASTER_ABORT. now_ns is this machine's clock, not simulated time.
struct hvp_bus hvp_vfio_user_bus(struct hvp_vfio_user* client);

// Reads or writes `bytes` at an offset of the function's configuration space.
int hvp_vfio_user_read_config(struct hvp_vfio_user* client, uint32_t offset, void* data,
                              uint32_t bytes);
int hvp_vfio_user_write_config(struct hvp_vfio_user* client, uint32_t offset, const void* data,
                               uint32_t bytes);

// Makes memory, zero at first, that the board reaches at `bus_address`: whole pages. Its segments
// go into struct hvp_dma. It is removed by hvp_vfio_user_unshare() with the same address and bytes,
// which also works after the connection has failed.
int hvp_vfio_user_share(struct hvp_vfio_user* client, uint64_t bus_address, size_t bytes,
                        void** memory);
int hvp_vfio_user_unshare(struct hvp_vfio_user* client, uint64_t bus_address, size_t bytes,
                          void* memory);

// Maps memory of the caller's: `bytes` of an open file from `offset` on, which the server maps too.
int hvp_vfio_user_map(struct hvp_vfio_user* client, uint64_t bus_address, size_t bytes, int file,
                      uint64_t offset);
int hvp_vfio_user_unmap(struct hvp_vfio_user* client, uint64_t bus_address, size_t bytes);

// Resets the board to its state after power-on and switches it on again.
int hvp_vfio_user_reset(struct hvp_vfio_user* client);

#ifdef __cplusplus
}
#endif

#endif
