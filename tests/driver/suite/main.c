#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "tests/driver/suite/suite.h"

// The suite on a board that has an address: a device file, as in a Linux guest.
//   hvp-driver-suite ADDRESS [--registers FILE] …
// FILE has the board's BAR, a word at its offset: tests/driver/linux/registers.

static int registers = -1;

static uint32_t peek(void* context, uint32_t offset) {
  uint32_t value = 0xffffffffU;
  (void)context;
  if (pread(registers, &value, sizeof value, (off_t)offset) != (ssize_t)sizeof value) {
    perror("a register cannot be read");
  }
  return value;
}

static void poke(void* context, uint32_t offset, uint32_t value) {
  (void)context;
  if (pwrite(registers, &value, sizeof value, (off_t)offset) != (ssize_t)sizeof value) {
    perror("a register cannot be written");
  }
}

static hvp_status open_address(void* context, struct hvp_client** client) {
  return hvp_client_open(client, context);
}

int main(int argc, char** argv) {
  if (argc == 2 && strcmp(argv[1], "--list") == 0) {
    suite_list();
    return 0;
  }
  if (argc < 2) {
    (void)fprintf(stderr, "expected an address: %s\n", hvp_client_schemes());
    return 2;
  }
  struct hvp_client* client = NULL;
  const hvp_status status = hvp_client_open(&client, argv[1]);
  if (status != HVP_OK) {
    (void)fprintf(stderr, "%s: %s (%s): expected %s\n", argv[1], hvp_status_text(status),
                  strerror(errno), hvp_client_schemes());
    return 2;
  }
  (void)hvp_client_close(client);
  struct suite_board board = {.context = argv[1], .open = open_address};
  board.time_runs_on = strncmp(argv[1], "vfio-user:", 10) == 0;
  int used = 2;
  if (argc > used && strcmp(argv[used], "--time-runs-on") == 0) {
    board.time_runs_on = true;
    ++used;
  }
  if (argc > used + 1 && strcmp(argv[used], "--registers") == 0) {
    registers = open(argv[used + 1], O_RDWR | O_CLOEXEC);
    if (registers < 0) {
      perror(argv[used + 1]);
      return 2;
    }
    board.peek = peek;
    board.poke = poke;
    used += 2;
  }
  return suite_main(&board, argc - used, argv + used);
}
