#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/linux/board_device.h"
#include "app/linux/calendar.h"
#include "app/linux/guest_process.h"
#include "app/linux/private_folder.h"
#include "app/linux/stream.h"
#include "vp/function/board_function.h"

namespace hvp::guest {

// What a kernel is started with.
struct GuestSettings {
  std::filesystem::path kernel;
  std::filesystem::path initrd;
  std::filesystem::path script;        // that the initrd's init is to run; empty: none
  std::string memory = "64M";          // as the kernel's option mem= takes it
  std::vector<std::string> arguments;  // further ones of the kernel
  std::optional<std::chrono::milliseconds> patience{60'000};  // none: it may be silent for ever
  bool hold = false;  // stopped before its first instruction, until a debugger lets it go on
  std::int64_t system_call_ns = 0;              // that a system call takes; 0: none
  std::function<void(std::string_view)> print;  // each line of its console
};

// A Linux kernel, as a process of this machine, whose only device is the board and whose clock is
// SystemC's.
class Guest {
 public:
  // Starts it. Keeps a reference.
  Guest(vp::BoardFunction& board, const GuestSettings& settings);

  struct End {
    bool interrupted = false;  // by the user
    // What the script ended with; none: there was no script, or it did not end.
    std::optional<int> script_status;
    std::optional<int> module_status;  // what insmod ended with, where that failed
  };
  // Simulates until the kernel has ended. Throws GuestError where it did not end as it should: it
  // panicked, hung, sleeps for ever, or said what it may not.
  End run();

  pid_t process() const { return process_.number(); }
  const BoardDevice::Counts& counts() const;
  // Whether it took the time for a system call that it was told to take; one without the patch does
  // not know of it.
  bool system_calls_take_time() const { return system_calls_take_time_; }
  // Simulated time when the kernel first asked for the board; none: it never did.
  std::optional<vp::Picoseconds> first_access() const { return first_access_; }

 private:
  std::vector<std::string> arguments(const GuestSettings& settings) const;
  void serve();
  void sleep();
  void connect();
  void judge_end();

  vp::BoardFunction& board_;
  PrivateFolder folder_;
  Listener calendar_socket_;
  Listener device_socket_;
  GuestProcess process_;
  Calendar calendar_;
  std::unique_ptr<BoardDevice> device_;
  std::int64_t system_call_ns_;
  bool system_calls_take_time_ = false;
  bool told_ = false;  // of something of the board's, since the guest began to wait
  std::optional<vp::Picoseconds> first_access_;
};

}  // namespace hvp::guest
