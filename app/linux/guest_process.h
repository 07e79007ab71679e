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
#include <utility>
#include <vector>

#include <sys/types.h>
#include <unistd.h>

#include "app/results/launched_program.h"

namespace hvp::guest {

// A file descriptor that is closed with its object.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { reset(); }
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    if (this != &other) {
      reset();
      number_ = std::exchange(other.number_, -1);
    }
    return *this;
  }

  int number() const { return number_; }
  explicit operator bool() const { return number_ >= 0; }
  void reset() {
    if (number_ >= 0) close(number_);
    number_ = -1;
  }

 private:
  int number_ = -1;
};

// The guest has ended or closed a connection. The exception is caught where the end is judged.
class GuestGone : public std::exception {};
// The user has ended the run.
class GuestInterrupted : public std::exception {};

// A User-Mode Linux process and its output. The process and all its children end with this object,
// and also with this program, however that ends: a keeper process waits for that and then removes
// `folder`.
class GuestProcess {
 public:
  struct Settings {
    std::filesystem::path kernel;
    std::vector<std::string> arguments;
    std::filesystem::path folder;
    // The wall-clock time for which the guest may neither do something that counts
    // (did_something()) nor print; the time of the simulation itself is excluded. None: no limit.
    std::optional<std::chrono::milliseconds> patience{60'000};
    // Stops the guest before its first instruction, until a debugger continues it.
    bool hold = false;
    // Receives each line that the guest prints, without its line break.
    std::function<void(std::string_view)> print;
  };
  // Throws std::system_error if the process cannot be started.
  explicit GuestProcess(const Settings& settings);
  ~GuestProcess();
  GuestProcess(const GuestProcess&) = delete;
  GuestProcess& operator=(const GuestProcess&) = delete;

  // Notes that the guest did something other than wait for its own timers.
  void did_something() { heard_at_ = Clock::now(); }
  // Excludes a time that the simulation took from the guest's silence.
  void forgive(std::chrono::steady_clock::duration time) { heard_at_ += time; }

  // Waits until one of these descriptors can be read or was closed at its other end, and returns
  // its index. Output of the guest is passed on meanwhile. Throws GuestHung if the guest was
  // silent for too long, GuestGone if it has ended, and GuestInterrupted.
  std::size_t wait_readable(std::span<const int> descriptors);
  // Waits for the guest's end and passes on its last output. Returns the exit status: -1 after a
  // signal, none if the guest does not end.
  std::optional<int> wait_for_end();
  pid_t number() const { return program_.process(); }
  // The guest's own message if it panicked.
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
  Descriptor alive_;  // the keeper reads the other end
};

}  // namespace hvp::guest
