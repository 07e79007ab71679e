#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <systemc>

#include "models/host/costs.h"
#include "models/host/shared_core.h"
#include "models/random/distribution.h"
#include "vp/frame/ledger.h"
#include "vp/latency_draws.h"

namespace hvp::vp {

// The operating system's delays between an event and the servo process that waits for it. Without
// the effects of [host] there are none: the process runs at its tick and when its interrupt is
// taken, and no call waits.
class Dispatcher {
 public:
  Dispatcher(const host::Host& costs, std::int64_t seed, Ledger& ledger);

  // The delay from n·T to the timer's release of frame n.
  Picoseconds release_delay(std::int64_t number) const;

  // The time from an interrupt that this frame waits for until its process is ready; `otherwise` if
  // none is drawn.
  Picoseconds interrupt_latency(std::int64_t frame, Picoseconds otherwise);

  // The servo process gives up its core and sleeps.
  void sleep();
  // The servo process works for this frame from now on; −1: for none.
  void work_for(std::int64_t frame);
  // The servo process has slept and is ready now, for the tag's frame. Waits until it runs; the
  // spans follow the tag. Called in the servo thread. A tag without a frame (set-up) draws nothing.
  void wake(Tag& tag);

  // acquire_core() and work() are for the other process, on a core of its own or a shared one, and
  // are called in its thread. Waits until the process has the core and is to run its first
  // instruction.
  void acquire_core();
  // Works for `time` of its own, however often it is preempted. Returns false if the core was lost
  // before the first instruction, so that no work was done.
  bool work(Picoseconds time);

 private:
  struct Shared {
    explicit Shared(const host::SharedCore::Settings& settings) : core(settings) {}
    host::SharedCore core;
    sc_core::sc_event freed;      // the servo process has freed the core
    sc_core::sc_event preempted;  // the other process was preempted
  };
  void delay(Tag& tag);
  void take_core(Tag& tag);
  void servo_ran() const;
  void other_ran(std::string_view what, Picoseconds since) const;

  std::optional<random::Source> jitter_;
  std::optional<random::Source> wake_up_;
  std::optional<LatencyDraws> interrupts_;
  std::optional<Shared> shared_;
  Ledger& ledger_;
  std::int64_t frame_ = -1;     // the frame that woke last
  std::uint32_t awakened_ = 0;  // number of times that the frame was woken
  Picoseconds runs_since_ = 0;  // since when the servo process has its core
  std::int64_t runs_for_ = -1;  // the frame for which it was woken
};

}  // namespace hvp::vp
