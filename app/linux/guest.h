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

#include "app/board/stop_points.h"
#include "app/linux/board_device.h"
#include "app/linux/calendar.h"
#include "app/linux/dma_check.h"
#include "app/linux/guest_process.h"
#include "app/linux/stream.h"
#include "app/process/temporary_folder.h"
#include "vp/function/outside_host.h"

namespace hvp::guest {

// The settings with which a kernel is started.
struct GuestSettings {
  std::filesystem::path kernel;
  std::filesystem::path initrd;
  std::filesystem::path script;        // run by the initrd's init; empty: none
  std::string memory = "64M";          // as the kernel's option mem= takes it
  std::vector<std::string> arguments;  // further arguments of the kernel
  std::optional<std::chrono::milliseconds> patience{60'000};  // none: no limit
  bool hold = false;  // stops it before its first instruction, until a debugger continues it
  std::int64_t system_call_ns = 0;  // time of a system call; 0: none
  // Where it is stopped, as StopPoints::add() takes it: at the first of these the run ends or, with
  // `hold`, the debugger gets the kernel at each.
  std::vector<std::string> stop_at;
  bool check_dma = false;  // the board reaches what its driver has mapped, and nothing else
  // The guest's stores become visible late, as this draws it (vp/bus/weak_memory.h); none: at once.
  std::optional<std::int64_t> weak_memory_seed;
  std::function<void(std::string_view)> print;  // receives each line of the console
  std::function<void(std::string_view)> say;    // receives what is said of a stop, a line or more
};

// A Linux kernel as a process of this machine. Its only device is the board, and its clock is
// SystemC's.
class Guest {
 public:
  // Starts the kernel. Keeps a reference to the board. Throws InputError for a wrong stop.
  Guest(vp::BoardFunction& board, const GuestSettings& settings);
  ~Guest();
  Guest(const Guest&) = delete;
  Guest& operator=(const Guest&) = delete;

  struct End {
    bool interrupted = false;  // by the user
    // The exit status of the script; none: there was no script, or it did not end.
    std::optional<int> script_status;
    std::optional<int> module_status;  // exit status of insmod if that failed
    bool stopped = false;              // at a point that was asked for
  };
  // Simulates until the kernel has ended. Throws GuestError if it did not end properly: it
  // panicked, hung, sleeps for ever, or broke the protocol.
  End run();
  // After run() threw GuestHung: what its processor does, the state of the board and the last
  // accesses to it, in several lines.
  std::string hang_text() const;

  pid_t process() const { return process_.number(); }
  const BoardDevice::Counts& counts() const;
  // None if DMA was not checked, or could not be.
  std::optional<DmaCheck::Counts> dma() const;
  // None if the guest's stores are in order, or its kernel does not tell of barriers.
  std::optional<vp::WeakMemory::Counts> memory_order() const;
  // True if a system call took the time that it was given. A kernel without the patch ignores that
  // time.
  bool system_calls_take_time() const { return system_calls_take_time_; }
  // A stop that was asked for and never came; empty: there is none.
  std::string never_stopped() const {
    return stop_points_ && !stopped_ ? stop_points_->never_came() : std::string();
  }
  // The simulated time at which the kernel first accessed the board; none: it never did.
  std::optional<vp::Picoseconds> first_access() const { return first_access_; }

 private:
  std::vector<std::string> arguments(const GuestSettings& settings) const;
  std::string board_text() const;
  void serve();
  void sleep();
  void connect();
  void judge_end();
  void stop(const app::Stop& stop);
  void give_to_debugger(const app::Stop& stop);

  vp::BoardFunction& board_;
  std::filesystem::path kernel_;
  app::TemporaryFolder folder_{"hvp-linux"};
  Listener calendar_socket_;
  Listener device_socket_;
  GuestProcess process_;
  Calendar calendar_;
  std::optional<DmaCheck> dma_check_;
  std::optional<vp::WeakMemory> weak_memory_;
  std::unique_ptr<BoardDevice> device_;
  std::function<void(std::string_view)> say_;
  std::optional<app::StopPoints> stop_points_;
  bool debugged_;
  bool stopped_ = false;
  std::int64_t system_call_ns_;
  bool system_calls_take_time_ = false;
  bool told_ = false;  // the guest was told of something of the board's while it waits
  std::optional<vp::Picoseconds> first_access_;
};

}  // namespace hvp::guest
