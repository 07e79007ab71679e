#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "vp/board/board_assembly.h"
#include "vp/bus/bus_assembly.h"
#include "vp/device/device_assembly.h"
#include "vp/frame/ledger.h"
#include "vp/frame/session.h"
#include "vp/platform_settings.h"

namespace hvp::vp {

// How much there is to solve and to draw.
struct Workload {
  bool has_board = true;  // false: the host solves
  Numbers numbers = Numbers::fixed;
  std::size_t memory_bytes = 0;  // of the host, that a board that is bus master reaches
  std::int64_t vertices = 0;     // of the surface that is drawn
};

// Everything beyond the processor: buses, solver board and haptic device, built and wired. It needs
// no host: whoever binds to from_host() and takes the interrupts drives it, and whoever is not a
// process of SystemC brings it forward with step_to().
class BoardSide {
 public:
  // Keeps references to all but the workload. The device counts time from session.begin.
  BoardSide(const PlatformSettings& settings, const Workload& workload, const Session& session,
            Ledger& ledger, AccessObserver* register_trace = nullptr);

  // Where the processor's accesses go in: kSolverBase and kDaqBase.
  tlm::tlm_target_socket<>& from_host() { return buses_.from_host(); }
  // The board's interrupts end at `host`. Once, after every other module is built. Throws as
  // BoardAssembly::connect() does.
  void connect(InterruptIf& host, std::function<bool()> messages_enabled = {});
  // Waits until nothing that was posted is under way; in the caller's process.
  void drain() { buses_.drain(); }

  // Simulates up to this time, events at it included; from outside any process. Throws
  // std::invalid_argument for a time that has passed.
  static void step_to(Picoseconds time);
  // When the next event is due; none where all wait for somebody from outside.
  static std::optional<Picoseconds> next_event();

  BusAssembly& buses() { return buses_; }
  const BusAssembly& buses() const { return buses_; }
  // Null where the host solves.
  BoardAssembly* board() { return board_.get(); }
  const BoardAssembly* board() const { return board_.get(); }
  plant::Device& device(std::size_t probe = 0) { return device_.device(probe); }
  std::size_t probes() const { return device_.probes(); }

 private:
  BusAssembly buses_;
  std::unique_ptr<BoardAssembly> board_;
  DeviceAssembly device_;
};

}  // namespace hvp::vp
