#include <cstdio>
#include <cstdlib>

#include "app/board/outside_board.h"
#include "app/commands/commands.h"
#include "app/commands/terminal.h"
#include "app/results/interruption.h"
#include "app/serve/server.h"

namespace hvp::app {

int serve_command(const ServeArguments& arguments) {
  const LoadedScenario loaded = load(arguments);
  check_kernel("HVP_KERNEL");
  // From the socket's first moment on a signal ends the program so that the socket goes with it.
  const results::DeferredInterruption deferred;
  {
    serve::BoardPort board(outside_board(loaded));
    serve::ListeningSocket socket(arguments.socket);
    print(
        "listening on {}; simulated time passes with the client's accesses and its jobs, not "
        "with the clock: for function, not for timing\n",
        arguments.socket.string());
    std::fflush(stdout);
    serve::Server(board, socket).run(arguments.once);
  }
  if (results::interrupted() != 0) {
    complain("hvp: interrupted");
    std::fflush(stdout);
    results::end_as_interrupted();
  }
  return kHeld;
}

}  // namespace hvp::app
