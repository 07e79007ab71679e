#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <systemc>

#include "models/host/costs.h"
#include "vp/frame/ledger.h"
#include "vp/function/config_space.h"
#include "vp/latency_draws.h"

namespace hvp::vp {

// The time between a function's interrupt and the host's handler: [host] interrupt_latency, or what
// [host.interrupt_latencies] draws for the interrupts of a job. One overtakes none. Each is a span
// of its frame, host interrupt, which ends when the handler runs.
class LateInterrupts : public sc_core::sc_module {
 public:
  // Nothing but `told` of a line that has gone up.
  using Message = std::optional<ConfigSpace::Message>;
  using Told = std::function<void(const Tag& tag, const Message& message)>;

  // `told` is called at its time, from within the simulation. Keeps a reference.
  LateInterrupts(const sc_core::sc_module_name& name, const host::Host& host, std::int64_t seed,
                 Ledger& ledger, Told told);

  // An interrupt of now.
  void raise(const Tag& tag, const Message& message);
  // The line has gone down before anybody heard of it.
  void forget_line();
  // A reset.
  void forget_all() { under_way_.clear(); }

 private:
  struct UnderWay {
    Picoseconds raised = 0;
    Picoseconds due = 0;
    Tag tag;
    Message message;
  };

  void deliver();
  void follow(Tag& tag, Picoseconds raised);

  Picoseconds latency_;
  std::optional<LatencyDraws> draws_;
  Ledger& ledger_;
  Told told_;
  std::deque<UnderWay> under_way_;
  sc_core::sc_event due_;
};

}  // namespace hvp::vp
