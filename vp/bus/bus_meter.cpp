#include "vp/bus/bus_meter.h"

#include <algorithm>
#include <utility>

#include "vp/frame/frame_tag.h"

namespace hvp::vp {

void BusMeter::begun() {
  uses_ = bus_.uses_until_now();
  begin_ = now_ps();
  busy_ = bus_.until_now();
}

void BusMeter::solved(const Frame& /*frame*/, const Solution& /*solution*/) {
  const Picoseconds time = now_ps();
  const Picoseconds busy = bus_.until_now();
  if (last_time_ >= 0 && time > last_time_) {
    const auto window = static_cast<double>(time - last_time_);
    worst_share_ = std::max(worst_share_, static_cast<double>(busy - last_busy_) / window);
  }
  last_time_ = time;
  last_busy_ = busy;
}

void BusMeter::ended() {
  end_ = now_ps();
  busy_ = bus_.busy() - busy_;
  BusUses now = bus_.uses();
  for (std::size_t i = 0; i < now.size() && i < uses_.size(); ++i) {
    now[i].busy -= uses_[i].busy;
    now[i].bytes -= uses_[i].bytes;
    now[i].transactions -= uses_[i].transactions;
  }
  uses_ = std::move(now);
  worst_share_ = std::max(worst_share_, share());
}

double BusMeter::share() const {
  return time() > 0 ? static_cast<double>(busy_) / static_cast<double>(time()) : 0;
}

}  // namespace hvp::vp
