#include "vp/board/board_side.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "models/config/input_error.h"
#include "vp/main_stack.h"

namespace hvp::vp {

namespace {
std::unique_ptr<BoardAssembly> make_board(const PlatformSettings& settings,
                                          const Workload& workload, Ledger& ledger,
                                          AccessObserver* register_trace) {
  if (workload.has_board) {
    return std::make_unique<BoardAssembly>(settings, workload.numbers, workload.memory_bytes,
                                           ledger, register_trace);
  }
  if (settings.waveform) throw InputError("waveform", "the host solves: there is no engine");
  return nullptr;
}
}  // namespace

BoardSide::BoardSide(const PlatformSettings& settings, const Workload& workload,
                     const Session& session, Ledger& ledger, AccessObserver* register_trace)
    : buses_(settings.bus, settings.fidelity.bus, settings.seed, workload.vertices, ledger),
      board_(make_board(settings, workload, ledger, register_trace)),
      device_(settings, session, ledger) {}

void BoardSide::connect(InterruptIf& host, std::function<bool()> messages_enabled) {
  if (board_ != nullptr) board_->connect(buses_, host, std::move(messages_enabled));
  device_.connect(buses_);
}

void BoardSide::step_to(Picoseconds time) {
  if (time < now_ps()) {
    throw std::invalid_argument("a step to " + std::to_string(time) + " ps at " +
                                std::to_string(now_ps()) + " ps");
  }
  sc_core::sc_start(to_sc_time(time - now_ps()), sc_core::SC_RUN_TO_TIME);
  // A step of no length makes one delta cycle only.
  while (sc_core::sc_pending_activity_at_current_time()) sc_core::sc_start(sc_core::SC_ZERO_TIME);
  return_to_main_stack();
}

std::optional<Picoseconds> BoardSide::next_event() {
  if (sc_core::sc_get_status() == sc_core::SC_ELABORATION) return now_ps();  // all begin at 0
  if (!sc_core::sc_pending_activity()) return std::nullopt;
  return now_ps() + static_cast<Picoseconds>(sc_core::sc_time_to_pending_activity().value());
}

}  // namespace hvp::vp
