#include "tests/driver/suite/board_in_process.h"

#include <stdio.h>
#include <string.h>

#include "app/board/hvp_board.h"

enum { MOST_OVERRIDES = 32, AREA_BYTES = 4096 };
#define AREA_ADDRESS ((uint64_t)0x10000000)

// b, U, the list, the record, values and their list, a page each.
static _Alignas(AREA_BYTES) uint32_t area[6][AREA_BYTES / sizeof(uint32_t)];

static struct {
  struct hvp_board* board;
  int give_up_with;
  struct hvp_segment to_board;
  struct hvp_segment to_host;
  struct hvp_segment values;
  struct hvp_dma dma;
} in_process;

static const struct hvp_bus* wrapped(void) { return hvp_board_bus(in_process.board); }

// The board's own call-backs keep their context; this one is in front of the wait.
static int wait_interrupt(void* context, uint64_t timeout_ns) {
  const int number = in_process.give_up_with;
  in_process.give_up_with = 0;
  return number < 0 ? number : wrapped()->wait_interrupt(context, timeout_ns);
}

static hvp_status open_board(void* context, struct hvp_client** client) {
  (void)context;
  struct hvp_bus bus = *wrapped();
  if (bus.wait_interrupt != NULL) bus.wait_interrupt = wait_interrupt;
  return hvp_client_open_bus(client, &bus);
}

static uint32_t peek(void* context, uint32_t offset) {
  (void)context;
  return wrapped()->read32(wrapped()->context, offset);
}

static void poke(void* context, uint32_t offset, uint32_t value) {
  (void)context;
  wrapped()->write32(wrapped()->context, offset, value);
}

static void interrupt_wait(void* context, int number) {
  (void)context;
  in_process.give_up_with = number;
}

static const struct hvp_dma* dma(void* context) {
  (void)context;
  return in_process.dma.list == NULL ? NULL : &in_process.dma;
}

static struct hvp_segment page(size_t i) {
  const struct hvp_segment segment = {area[i], AREA_ADDRESS + i * AREA_BYTES, AREA_BYTES};
  return segment;
}

int board_in_process(struct suite_board* board, int argc, char** argv) {
  const char* overrides[MOST_OVERRIDES];
  size_t count = 0;
  int used = 1;
  while (used + 1 < argc && strcmp(argv[used], "--set") == 0 && count < MOST_OVERRIDES) {
    overrides[count++] = argv[used + 1];
    used += 2;
  }
  char why[512] = "expected SCENARIO.toml [--set KEY=VALUE]...";
  const struct hvp_board_options options = {.overrides = overrides, .override_count = count};
  if (argc > 0) in_process.board = hvp_board_open(argv[0], &options, why, sizeof why);
  if (in_process.board == NULL) {
    (void)fprintf(stderr, "%s\n", why);
    return 0;
  }
  if (hvp_board_map(in_process.board, AREA_ADDRESS, area, sizeof area)) {
    in_process.to_board = page(0);
    in_process.to_host = page(1);
    in_process.values = page(4);
    in_process.dma = (struct hvp_dma){.to_board = &in_process.to_board,
                                      .to_board_count = 1,
                                      .to_host = &in_process.to_host,
                                      .to_host_count = 1,
                                      .list = area[2],
                                      .list_address = page(2).bus_address,
                                      .record = area[3],
                                      .record_address = page(3).bus_address,
                                      .values = &in_process.values,
                                      .values_count = 1,
                                      .values_list = area[5],
                                      .values_list_address = page(5).bus_address};
  }
  *board = (struct suite_board){
      .open = open_board, .peek = peek, .poke = poke, .interrupt_wait = interrupt_wait, .dma = dma};
  return used;
}

void board_in_process_close(void) { hvp_board_close(in_process.board); }
