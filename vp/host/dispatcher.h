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

// What the operating system puts between an event and the servo process that waits for it. Without
// the effects of [host] there is nothing: the process runs at its tick and when its interrupt has
// been taken, and nothing here waits.
class Dispatcher {
 public:
  Dispatcher(const host::Host& costs, std::int64_t seed, Ledger& ledger);

  // How long after n·T the timer releases frame n.
  Picoseconds release_delay(std::int64_t number) const;

  // From an interrupt that this frame waits for until its process is ready; `otherwise` where
  // nothing is drawn.
  Picoseconds interrupt_latency(std::int64_t frame, Picoseconds otherwise);

  // The servo process gives its core up, to sleep.
  void sleep();
  // From now on it works for this frame; −1: for none.
  void work_for(std::int64_t frame);
  // It has slept and was made ready now, for the tag's frame. Waits until it runs; the spans follow
  // the tag. Called in the servo thread. A tag without a frame (set-up) draws nothing.
  void wake(Tag& tag);

  // The other process, on a core of its own or one that both share; each called in its thread.
  // Waits until it has the core and is to run its first instruction.
  void acquire_core();
  // Works for so long of its own time, however often it is preempted. False where the core was lost
  // before the first instruction: it did nothing.
  bool work(Picoseconds time);

 private:
  struct Shared {
    explicit Shared(const host::SharedCore::Settings& settings) : core(settings) {}
    host::SharedCore core;
    sc_core::sc_event freed;      // by the servo process
    sc_core::sc_event preempted;  // the other process
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
  std::int64_t frame_ = -1;     // that woke last
  std::uint32_t awakened_ = 0;  // how often that frame was woken
  Picoseconds runs_since_ = 0;  // the servo process has its core, from power-up on
  std::int64_t runs_for_ = -1;  // the frame for which it was woken
};

}  // namespace hvp::vp
