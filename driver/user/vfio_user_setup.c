// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
// A connection from its first message to its last, and memory that is shared over it.
#include <errno.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include "driver/user/vfio_user_client.h"
#include "driver/user/vfio_user_message.h"
#include "driver/user/vfio_user_wire.h"

// No answer of a running server takes so long: the longest is that of an access behind the start of
// a job, whose words are computed in between.
enum { PATIENCE_S = 60 };

// What every server takes in one message.
enum { DEFAULT_TRANSFER = 1 << 20 };

// Places of the configuration space (PCI 3.0 §6.1, §6.8.1, §6.8.2).
enum {
  PCI_COMMAND = 0x04,
  PCI_CAPABILITIES = 0x34,
  PCI_MEMORY_AND_MASTER = 6,
  PCI_ID_MSI = 5,
  PCI_ID_MSI_X = 0x11,
  PCI_MSI_CONTROL = 2,
  PCI_MSI_ENABLE = 1,
  PCI_MSI_X_ENABLE = 1 << 15,
  PCI_MOST_CAPABILITIES = 48,  // of four bytes, behind the header
};

static int connect_to(struct hvp_vfio_user* client, const char* path) {
  struct sockaddr_un address = {.sun_family = AF_UNIX};
  const size_t length = strlen(path);
  if (length >= sizeof address.sun_path) return -ENAMETOOLONG;
  memcpy(address.sun_path, path, length);
  client->socket = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (client->socket < 0) return -errno;
  const struct timeval patience = {.tv_sec = PATIENCE_S};
  (void)setsockopt(client->socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  (void)setsockopt(client->socket, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
  if (connect(client->socket, (const struct sockaddr*)&address, sizeof address) != 0) {
    return -errno;
  }
  return 0;
}

static int agree(struct hvp_vfio_user* client) {
  const struct wire_version wanted = {.major = 0, .minor = 1};
  struct wire_version version = {0};
  // The terminating NUL is a part of it.
  static const char capabilities[] = "{\"capabilities\":{\"max_msg_fds\":1}}";
  const struct wire_request request = {.command = WIRE_VERSION,
                                       .fields = &wanted,
                                       .field_bytes = sizeof wanted,
                                       .data = capabilities,
                                       .data_bytes = sizeof capabilities,
                                       .file = -1};
  const int status = wire_exchange(client, &request, &version, sizeof version, NULL, 0);
  if (status != 0) return status;
  return version.major == wanted.major && version.minor <= wanted.minor ? 0 : -EPROTO;
}

static int look_at_bar(struct hvp_vfio_user* client) {
  struct wire_region region = {.argsz = sizeof region, .index = WIRE_BAR0};
  const struct wire_request request = {
      .command = WIRE_REGION_INFO, .fields = &region, .field_bytes = sizeof region, .file = -1};
  struct wire_region answer = {0};
  const int status = wire_exchange(client, &request, &answer, sizeof answer, NULL, 0);
  client->bar_bytes = answer.size;
  if (status != 0) return status;
  return answer.size > 0 ? 0 : -EPROTO;
}

// Where the list of capabilities has the messages, and by which capability; 0: nowhere.
static int find_messages(struct hvp_vfio_user* client, uint8_t* at, uint8_t* id) {
  uint8_t place = 0;
  int status = hvp_vfio_user_read_config(client, PCI_CAPABILITIES, &place, sizeof place);
  // All ones are those of a function that was pulled out.
  if (place == 0xff) place = 0;
  for (int i = 0; status == 0 && place != 0 && i < PCI_MOST_CAPABILITIES; ++i) {
    uint8_t capability[2] = {0};
    place &= 0xfc;
    status = hvp_vfio_user_read_config(client, place, capability, sizeof capability);
    *id = capability[0];
    if (*id == PCI_ID_MSI || *id == PCI_ID_MSI_X) break;
    place = capability[1];
  }
  *at = place;
  return status;
}

static int switch_on(struct hvp_vfio_user* client) {
  const uint16_t on = PCI_MEMORY_AND_MASTER;
  int status = hvp_vfio_user_write_config(client, PCI_COMMAND, &on, sizeof on);
  uint8_t messages = 0;
  uint8_t id = 0;
  if (status == 0) status = find_messages(client, &messages, &id);
  client->messages = messages != 0;
  client->masked = false;
  const struct wire_set_irqs set = {.argsz = sizeof set,
                                    .flags = WIRE_DATA_EVENTFD | WIRE_ACTION_TRIGGER,
                                    .index = !client->messages    ? WIRE_INTX
                                             : id == PCI_ID_MSI_X ? WIRE_MSI_X
                                                                  : WIRE_MSI,
                                    .count = 1};
  if (status == 0) {
    status = wire_command(client, WIRE_SET_IRQS, &set, sizeof set, client->interrupt);
  }
  if (status != 0 || !client->messages) return status;
  const uint32_t at = (uint32_t)messages + PCI_MSI_CONTROL;
  uint16_t control = 0;
  status = hvp_vfio_user_read_config(client, at, &control, sizeof control);
  control |= (uint16_t)(id == PCI_ID_MSI_X ? PCI_MSI_X_ENABLE : PCI_MSI_ENABLE);
  return status != 0 ? status : hvp_vfio_user_write_config(client, at, &control, sizeof control);
}

int hvp_vfio_user_open(struct hvp_vfio_user* client, const char* path) {
  *client =
      (struct hvp_vfio_user){.socket = -1, .interrupt = -1, .transfer_bytes = DEFAULT_TRANSFER};
  client->interrupt = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  int status = client->interrupt < 0 ? -errno : connect_to(client, path);
  if (status == 0) status = agree(client);
  if (status == 0) status = look_at_bar(client);
  if (status == 0) status = switch_on(client);
  if (status != 0) hvp_vfio_user_close(client);
  return status;
}

void hvp_vfio_user_close(struct hvp_vfio_user* client) {
  if (client->socket >= 0) (void)close(client->socket);
  if (client->interrupt >= 0) (void)close(client->interrupt);
  client->socket = -1;
  client->interrupt = -1;
  (void)wire_fail(client, ENOTCONN);
}

int hvp_vfio_user_reset(struct hvp_vfio_user* client) {
  const int status = wire_command(client, WIRE_DEVICE_RESET, NULL, 0, -1);
  return status == 0 ? switch_on(client) : status;
}

int hvp_vfio_user_map(struct hvp_vfio_user* client, uint64_t bus_address, size_t bytes, int file,
                      uint64_t offset) {
  const struct wire_map map = {.argsz = sizeof map,
                               .flags = WIRE_MEMORY_READ | WIRE_MEMORY_WRITE,
                               .offset = offset,
                               .address = bus_address,
                               .size = bytes};
  return wire_command(client, WIRE_DMA_MAP, &map, sizeof map, file);
}

int hvp_vfio_user_unmap(struct hvp_vfio_user* client, uint64_t bus_address, size_t bytes) {
  const struct wire_unmap unmap = {.argsz = sizeof unmap, .address = bus_address, .size = bytes};
  return wire_command(client, WIRE_DMA_UNMAP, &unmap, sizeof unmap, -1);
}

int hvp_vfio_user_share(struct hvp_vfio_user* client, uint64_t bus_address, size_t bytes,
                        void** memory) {
  *memory = NULL;
  const int file = memfd_create("hvp-dma", MFD_CLOEXEC);
  if (file < 0) return -errno;
  int status = ftruncate(file, (off_t)bytes) == 0 ? 0 : -errno;
  void* mine = MAP_FAILED;
  if (status == 0) {
    mine = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (mine == MAP_FAILED) status = -errno;
  }
  if (status == 0) status = hvp_vfio_user_map(client, bus_address, bytes, file, 0);
  (void)close(file);
  if (status == 0) {
    *memory = mine;
  } else if (mine != MAP_FAILED) {
    (void)munmap(mine, bytes);
  }
  return status;
}

int hvp_vfio_user_unshare(struct hvp_vfio_user* client, uint64_t bus_address, size_t bytes,
                          void* memory) {
  const int status = hvp_vfio_user_unmap(client, bus_address, bytes);
  (void)munmap(memory, bytes);
  return status;
}
