#ifndef HVP_VFIO_USER_MESSAGE_H
#define HVP_VFIO_USER_MESSAGE_H

#include "driver/user/vfio_user_client.h"

// A client's messages. What is returned is 0 or a negative error number; one that the server has
// replied with leaves the connection standing, any other ends it.

// A command's bytes: its structure, and data behind it.
struct wire_request {
  uint16_t command;
  bool no_reply;
  const void* fields;
  size_t field_bytes;
  const void* data;
  size_t data_bytes;
  int file;  // that goes with it; -1: none
};

// The reply's structure, and data behind it; what is longer is dropped.
int wire_exchange(struct hvp_vfio_user* client, const struct wire_request* request, void* fields,
                  size_t field_bytes, void* data, size_t data_bytes);
// A command whose reply has nothing of interest.
int wire_command(struct hvp_vfio_user* client, uint16_t number, const void* fields, size_t bytes,
                 int file);
int wire_read(struct hvp_vfio_user* client, uint32_t region, uint64_t offset, void* data,
              uint32_t bytes);
// Posted: nobody waits for it, and a later read follows it.
int wire_write(struct hvp_vfio_user* client, uint32_t region, uint64_t offset, const void* data,
               uint32_t bytes, bool posted);
// The connection has ended by this error number, unless it had before.
int wire_fail(struct hvp_vfio_user* client, int error);

#endif
