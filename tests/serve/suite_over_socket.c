#include <stdio.h>

#include "driver/user/vfio_user_client.h"
#include "tests/driver/suite/suite.h"

// The driver's suite on a board that `hvp serve` has: SOCKET and the suite's own arguments. Each
// case is a client of its own.

enum { PAGE_BYTES = 4096, AREA_BYTES = 6 * PAGE_BYTES };
#define AREA_ADDRESS ((uint64_t)0x10000000)

static struct {
  const char* path;
  struct hvp_vfio_user way;
  struct hvp_bus bus;
  int give_up_with;
  void* area;  // b, U, the list, the record, values and their list, a page each
  struct hvp_segment to_board;
  struct hvp_segment to_host;
  struct hvp_segment values;
  struct hvp_dma dma;
} served;

static int wait_interrupt(void* context, uint64_t timeout_ns) {
  const int number = served.give_up_with;
  served.give_up_with = 0;
  return number < 0 ? number : served.bus.wait_interrupt(context, timeout_ns);
}

static void leave(void* context) {
  (void)context;
  if (served.area != NULL) {
    (void)hvp_vfio_user_unshare(&served.way, AREA_ADDRESS, AREA_BYTES, served.area);
  }
  served.area = NULL;
  hvp_vfio_user_close(&served.way);
}

static struct hvp_segment page(size_t i) {
  const struct hvp_segment segment = {
      .memory = (uint32_t*)served.area + i * PAGE_BYTES / sizeof(uint32_t),
      .bus_address = AREA_ADDRESS + i * PAGE_BYTES,
      .bytes = PAGE_BYTES,
  };
  return segment;
}

static hvp_status open_served(void* context, struct hvp_client** client) {
  (void)context;
  const int error = hvp_vfio_user_open(&served.way, served.path);
  if (error != 0) {
    (void)fprintf(stderr, "%s: error %d\n", served.path, -error);
    return HVP_ERROR_NO_DEVICE;
  }
  served.bus = hvp_vfio_user_bus(&served.way);
  struct hvp_bus bus = served.bus;
  bus.wait_interrupt = wait_interrupt;
  if (hvp_vfio_user_share(&served.way, AREA_ADDRESS, AREA_BYTES, &served.area) != 0) {
    leave(NULL);
    return HVP_ERROR_BUS;
  }
  served.to_board = page(0);
  served.to_host = page(1);
  served.values = page(4);
  served.dma = (struct hvp_dma){.to_board = &served.to_board,
                                .to_board_count = 1,
                                .to_host = &served.to_host,
                                .to_host_count = 1,
                                .list = page(2).memory,
                                .list_address = page(2).bus_address,
                                .record = page(3).memory,
                                .record_address = page(3).bus_address,
                                .values = &served.values,
                                .values_count = 1,
                                .values_list = page(5).memory,
                                .values_list_address = page(5).bus_address};
  const hvp_status status = hvp_client_open_bus(client, &bus);
  if (status == HVP_OK) {
    hvp_client_at_close(*client, leave, NULL);
  } else {
    leave(NULL);
  }
  return status;
}

static uint32_t peek(void* context, uint32_t offset) {
  (void)context;
  return served.bus.read32(served.bus.context, offset);
}

static void poke(void* context, uint32_t offset, uint32_t value) {
  (void)context;
  served.bus.write32(served.bus.context, offset, value);
}

static void interrupt_wait(void* context, int number) {
  (void)context;
  served.give_up_with = number;
}

static const struct hvp_dma* dma(void* context) {
  (void)context;
  return &served.dma;
}

int main(int argc, char** argv) {
  if (argc < 2) {
    (void)fprintf(stderr, "expected a socket\n");
    return 2;
  }
  served.path = argv[1];
  struct suite_board board = {.open = open_served,
                              .peek = peek,
                              .poke = poke,
                              .interrupt_wait = interrupt_wait,
                              .dma = dma,
                              .time_runs_on = true};
  return suite_main(&board, argc - 2, argv + 2);
}
