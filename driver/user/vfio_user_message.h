// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#ifndef HVP_VFIO_USER_MESSAGE_H
#define HVP_VFIO_USER_MESSAGE_H

#include "driver/user/vfio_user_client.h"

// A client's messages. The functions return 0 or a negative error number. After an error that the
// server has replied with the connection is still open; any other ends it.

// A command: its structure, and data behind it.
struct wire_request {
  uint16_t command;
  bool no_reply;
  const void* fields;
  size_t field_bytes;
  const void* data;
  size_t data_bytes;
  int file;  // a file sent with it; -1: none
};

// Sends a command and receives the reply's structure and the data behind it; longer data is
// dropped.
int wire_exchange(struct hvp_vfio_user* client, const struct wire_request* request, void* fields,
                  size_t field_bytes, void* data, size_t data_bytes);
// Sends a command whose reply has no contents.
int wire_command(struct hvp_vfio_user* client, uint16_t number, const void* fields, size_t bytes,
                 int file);
int wire_read(struct hvp_vfio_user* client, uint32_t region, uint64_t offset, void* data,
              uint32_t bytes);
// A posted write is not waited for, and a later read follows it.
int wire_write(struct hvp_vfio_user* client, uint32_t region, uint64_t offset, const void* data,
               uint32_t bytes, bool posted);
// Ends the connection with this error number, unless it had ended before.
int wire_fail(struct hvp_vfio_user* client, int error);

#endif
