#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <sys/types.h>

#include "app/linux/descriptor.h"
#include "app/results/launched_program.h"

namespace hvp::guest {

// The guest has closed a connection, or ended: to be caught where its end is judged.
class GuestGone : public std::exception {};
// The user has ended the run.
class GuestInterrupted : public std::exception {};

// A User-Mode Linux, a program as any other, with what it prints. It and everything that it started
// end with this object, and with this program, however that ends: a process waits beside it for
// that. `folder` is removed then too.
class GuestProcess {
 public:
  struct Settings {
    std::filesystem::path kernel;
    std::vector<std::string> arguments;
    std::filesystem::path folder;
    // Of wall-clock time, for which it may do nothing that counts (did_something()) and print
    // nothing; what the simulation takes is not the guest's. None: any time.
    std::optional<std::chrono::milliseconds> patience{60'000};
    // It is stopped before its first instruction, until a debugger lets it go on.
    bool hold = false;
    // Each line that it prints, without its end.
    std::function<void(std::string_view)> print;
  };
  // Throws std::system_error where no process can be had.
  explicit GuestProcess(const Settings& settings);
  ~GuestProcess();
  GuestProcess(const GuestProcess&) = delete;
  GuestProcess& operator=(const GuestProcess&) = delete;

  // It has done something else than wait for its own timers.
  void did_something() { heard_at_ = Clock::now(); }
  // So much of the time since then was not the guest's.
  void forgive(std::chrono::steady_clock::duration time) { heard_at_ += time; }

  // Until one of these descriptors can be read, or was closed at its other end; its place. What the
  // guest prints is handed on meanwhile. Throws GuestError when nothing was heard of the guest for
  // too long, GuestGone when it ended, and GuestInterrupted.
  std::size_t wait_readable(std::span<const int> descriptors);
  // Waits for its end, and hands on what it still prints. Its exit status; -1 for a signal, and
  // none where it does not end.
  std::optional<int> wait_for_end();
  pid_t number() const { return program_.process(); }
  // What it panicked of, in its own words, where it did.
  const std::optional<std::string>& panic() const { return panic_; }

 private:
  using Clock = std::chrono::steady_clock;

  struct Console {
    int descriptor;
    std::string line;
    bool open = true;
  };
  void relay(Console& console);
  void print(Console& console);
  void start_keeper(const std::filesystem::path& folder);

  std::optional<std::chrono::milliseconds> patience_;
  Clock::time_point heard_at_ = Clock::now();
  std::function<void(std::string_view)> print_;
  results::LaunchedProgram program_;
  std::vector<Console> consoles_;
  std::optional<std::string> panic_;
  pid_t keeper_ = -1;
  Descriptor alive_;  // the keeper reads its other end
};

}  // namespace hvp::guest
