#pragma once

#include <cstdint>
#include <optional>

#include "models/host/costs.h"
#include "models/random/distribution.h"
#include "vp/ledger.h"

namespace hvp::vp {

// What the operating system puts between an event and the servo process that waits for it. Without
// the effects of [host] there is nothing: the process runs at its tick and when its interrupt has
// been taken, and nothing here waits.
class Dispatcher {
 public:
  Dispatcher(const host::Host& costs, std::int64_t seed, Ledger& ledger);

  // How long after n·T the timer releases frame n.
  Picoseconds release_delay(std::int64_t number) const;

  // The process has slept and was made ready now, for the tag's frame. Waits until it runs; the
  // spans follow the tag. Called in the servo thread. A tag without a frame costs nothing.
  void wake(Tag& tag);

 private:
  std::optional<random::Source> jitter_;
  std::optional<random::Source> wake_up_;
  Ledger& ledger_;
  std::int64_t frame_ = -1;     // that woke last
  std::uint32_t awakened_ = 0;  // how often that frame was woken
};

}  // namespace hvp::vp
