#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/driver/suite/suite.h"

// The suite on a board that has an address: a device file, as in a Linux guest.

static hvp_status open_address(void* context, struct hvp_client** client) {
  return hvp_client_open(client, context);
}

int main(int argc, char** argv) {
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
  return suite_main(&board, argc - 2, argv + 2);
}
