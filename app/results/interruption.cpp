#include "app/results/interruption.h"

#include <array>
#include <csignal>
#include <cstdlib>
#include <string_view>

#include <unistd.h>

#include "app/results/unfinished_file.h"

namespace hvp::results {
namespace {

constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP};

volatile std::sig_atomic_t deferred = 0;
volatile std::sig_atomic_t noted = 0;
volatile std::sig_atomic_t on_terminal = 0;

// Only what POSIX allows in a signal handler (signal-safety(7)).
void say(std::string_view text) {
  const ssize_t ignored = ::write(STDERR_FILENO, text.data(), text.size());
  static_cast<void>(ignored);
}

// Takes effect when the handler returns, or at once where there is none.
void raise_by_default(int number) {
  struct sigaction action {};
  action.sa_handler = SIG_DFL;
  ::sigaction(number, &action, nullptr);
  ::raise(number);
}

extern "C" void take_signal(int number) {
  if (deferred != 0 && noted == 0) {
    noted = number;
    return;
  }
  UnfinishedFile::remove_all();
  if (on_terminal != 0) say("\r\033[K");
  say("hvp: interrupted\n");
  raise_by_default(number);
}

}  // namespace

void end_cleanly_when_interrupted() {
  on_terminal = ::isatty(STDERR_FILENO);
  for (const int number : kSignals) {
    struct sigaction before {};
    if (::sigaction(number, nullptr, &before) != 0 || before.sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = take_signal;
    // One after the other: the second one must find what the first one has noted.
    for (const int other : kSignals) ::sigaddset(&action.sa_mask, other);
    ::sigaction(number, &action, nullptr);
  }
}

DeferredInterruption::DeferredInterruption() {
  noted = 0;
  deferred = 1;
}

DeferredInterruption::~DeferredInterruption() { deferred = 0; }

int interrupted() { return noted; }

void end_as_interrupted() {
  UnfinishedFile::remove_all();
  raise_by_default(noted);
  std::_Exit(128 + noted);
}

}  // namespace hvp::results
