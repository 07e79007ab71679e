#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include "app/board/outside_board.h"
#include "app/commands/commands.h"
#include "app/commands/terminal.h"
#include "app/results/interruption.h"
#include "app/results/register_trace.h"
#include "app/results/results_folder.h"
#include "app/serve/server.h"

namespace hvp::app {

namespace fs = std::filesystem;

int serve_command(const ServeArguments& arguments) {
  const LoadedScenario loaded = load(arguments);
  check_kernel("HVP_KERNEL");
  const vp::PlatformSettings settings = outside_board(loaded);
  fs::path out = arguments.out;
  std::optional<results::FolderLock> lock;
  std::optional<results::RegisterTrace> registers;
  if (arguments.trace_registers) {
    if (out.empty()) (out = results_folder(arguments)) += "-serve";
    results::create_folder(out, "--out");
    lock.emplace(out);
  }
  // From the socket's first moment on a signal ends the program so that the socket goes with it.
  const results::DeferredInterruption deferred;
  {
    serve::ListeningSocket socket(arguments.socket);
    if (lock) registers.emplace(out);
    serve::BoardPort board(settings, registers ? &*registers : nullptr);
    print(
        "listening on {}; simulated time passes with the client's accesses and its jobs, not "
        "with the clock: for function, not for timing\n",
        arguments.socket.string());
    std::fflush(stdout);
    serve::Server(board, socket).run(arguments.once);
    if (registers) {
      registers->finish();
      print("every access is in {}\n", (out / "registers.log").string());
    }
  }
  if (results::interrupted() != 0) {
    complain("hvp: interrupted");
    std::fflush(stdout);
    results::end_as_interrupted();
  }
  return kHeld;
}

}  // namespace hvp::app
