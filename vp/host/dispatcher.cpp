#include "vp/host/dispatcher.h"

#include <cmath>
#include <systemc>

#include "vp/frame_tag.h"

namespace hvp::vp {

namespace {
std::optional<random::Source> source(const std::optional<random::TimeDistribution>& distribution,
                                     std::int64_t seed, const char* effect) {
  if (!distribution) return std::nullopt;
  return random::Source(*distribution, seed, effect);
}

Picoseconds to_ps(double seconds) { return std::llround(seconds * 1e12); }
}  // namespace

Dispatcher::Dispatcher(const host::Host& costs, std::int64_t seed, Ledger& ledger)
    : jitter_(source(costs.jitter, seed, "host.jitter")),
      wake_up_(source(costs.wake_up, seed, "host.wake_up")),
      ledger_(ledger) {}

Picoseconds Dispatcher::release_delay(std::int64_t number) const {
  return jitter_ ? to_ps(jitter_->time_s(number)) : 0;
}

void Dispatcher::wake(Tag& tag) {
  if (!wake_up_ || tag.frame < 0) return;
  if (tag.frame != frame_) {
    frame_ = tag.frame;
    awakened_ = 0;
  }
  const Picoseconds ready = now_ps();
  sc_core::wait(to_sc_time(to_ps(wake_up_->time_s(frame_, awakened_++))));
  ledger_.extend(tag, Part::host, Phase::wake_up, ready, now_ps());
}

}  // namespace hvp::vp
