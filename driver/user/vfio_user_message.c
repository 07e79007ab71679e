// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
// Messages over the socket: a command, and its reply where one is wanted.
#include "driver/user/vfio_user_message.h"

#include <errno.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include "driver/user/vfio_user_wire.h"

int wire_fail(struct hvp_vfio_user* client, int error) {
  if (client->error == 0) client->error = error;
  return -client->error;
}

static int send_request(struct hvp_vfio_user* client, const struct wire_request* request,
                        uint16_t id) {
  struct wire_header header = {
      .id = id,
      .command = request->command,
      .size = (uint32_t)(sizeof header + request->field_bytes + request->data_bytes),
      .flags = request->no_reply ? WIRE_NO_REPLY : 0};
  // The message's parts are read only, which struct iovec cannot say.
  // NOLINTBEGIN(performance-no-int-to-ptr)
  struct iovec parts[3] = {{&header, sizeof header},
                           {(void*)(uintptr_t)request->fields, request->field_bytes},
                           {(void*)(uintptr_t)request->data, request->data_bytes}};
  // NOLINTEND(performance-no-int-to-ptr)
  union {
    struct cmsghdr header;
    char bytes[CMSG_SPACE(sizeof(int))];
  } control = {{0}};
  struct msghdr message = {.msg_iov = parts, .msg_iovlen = 3};
  if (request->file >= 0) {
    message.msg_control = control.bytes;
    message.msg_controllen = sizeof control.bytes;
    struct cmsghdr* files = CMSG_FIRSTHDR(&message);
    files->cmsg_level = SOL_SOCKET;
    files->cmsg_type = SCM_RIGHTS;
    files->cmsg_len = CMSG_LEN(sizeof(int));
    memcpy(CMSG_DATA(files), &request->file, sizeof(int));
  }
  while (message.msg_iovlen > 0) {
    ssize_t sent = sendmsg(client->socket, &message, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) return -errno;
    message.msg_control = NULL;
    message.msg_controllen = 0;
    size_t rest = (size_t)sent;
    while (message.msg_iovlen > 0 && rest >= message.msg_iov->iov_len) {
      rest -= message.msg_iov->iov_len;
      ++message.msg_iov;
      --message.msg_iovlen;
    }
    if (message.msg_iovlen == 0) break;
    message.msg_iov->iov_base = (char*)message.msg_iov->iov_base + rest;
    message.msg_iov->iov_len -= rest;
  }
  return 0;
}

static int receive_bytes(struct hvp_vfio_user* client, void* data, size_t bytes) {
  char* to = data;
  while (bytes > 0) {
    ssize_t got = recv(client->socket, to, bytes, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return errno == EAGAIN ? -ETIMEDOUT : -errno;
    if (got == 0) return -EPIPE;
    to += got;
    bytes -= (size_t)got;
  }
  return 0;
}

static int drop_bytes(struct hvp_vfio_user* client, size_t bytes) {
  char unused[256];
  while (bytes > 0) {
    size_t part = bytes < sizeof unused ? bytes : sizeof unused;
    int status = receive_bytes(client, unused, part);
    if (status != 0) return status;
    bytes -= part;
  }
  return 0;
}

// A reply's body: as much of it as there is room for, `fields` first. An error of the server's
// leaves the connection standing.
static int receive_reply(struct hvp_vfio_user* client, uint16_t id, void* fields,
                         size_t field_bytes, void* data, size_t data_bytes) {
  struct wire_header header;
  int status = receive_bytes(client, &header, sizeof header);
  if (status != 0) return wire_fail(client, -status);
  if ((header.flags & WIRE_TYPE) != WIRE_REPLY || header.size < sizeof header) {
    return wire_fail(client, EPROTO);
  }
  size_t body = header.size - sizeof header;
  if ((header.flags & WIRE_ERROR) != 0) {
    status = drop_bytes(client, body);
    if (status != 0) return wire_fail(client, -status);
    return header.error > 0 && header.error < 4096 ? -(int)header.error : -EIO;
  }
  if (header.id != id || body < field_bytes + data_bytes) return wire_fail(client, EPROTO);
  status = receive_bytes(client, fields, field_bytes);
  if (status == 0) status = receive_bytes(client, data, data_bytes);
  if (status == 0) status = drop_bytes(client, body - field_bytes - data_bytes);
  return status == 0 ? 0 : wire_fail(client, -status);
}

int wire_exchange(struct hvp_vfio_user* client, const struct wire_request* request, void* fields,
                  size_t field_bytes, void* data, size_t data_bytes) {
  if (client->error != 0) return -client->error;
  const uint16_t id = client->next_id++;
  int status = send_request(client, request, id);
  // Who is refused at once finds its connection shut, and why in front of that.
  if (status != 0 && request->command != WIRE_VERSION) return wire_fail(client, -status);
  if (request->no_reply) return 0;
  return receive_reply(client, id, fields, field_bytes, data, data_bytes);
}

int wire_command(struct hvp_vfio_user* client, uint16_t number, const void* fields, size_t bytes,
                 int file) {
  const struct wire_request request = {
      .command = number, .fields = fields, .field_bytes = bytes, .file = file};
  return wire_exchange(client, &request, NULL, 0, NULL, 0);
}

int wire_read(struct hvp_vfio_user* client, uint32_t region, uint64_t offset, void* data,
              uint32_t bytes) {
  struct wire_access access = {offset, region, bytes};
  const struct wire_request request = {
      .command = WIRE_REGION_READ, .fields = &access, .field_bytes = sizeof access, .file = -1};
  struct wire_access answer;
  return wire_exchange(client, &request, &answer, sizeof answer, data, bytes);
}

int wire_write(struct hvp_vfio_user* client, uint32_t region, uint64_t offset, const void* data,
               uint32_t bytes, bool posted) {
  struct wire_access access = {offset, region, bytes};
  const struct wire_request request = {.command = WIRE_REGION_WRITE,
                                       .no_reply = posted,
                                       .fields = &access,
                                       .field_bytes = sizeof access,
                                       .data = data,
                                       .data_bytes = bytes,
                                       .file = -1};
  return wire_exchange(client, &request, NULL, 0, NULL, 0);
}
