#include "vp/fpga/engine/engine_clock.h"

#include <utility>

namespace hvp::vp::engine {

EngineClock::EngineClock(const sc_core::sc_module_name& name, std::int64_t period_ps,
                         std::function<void()> units)
    : sc_module(name),
      period_(static_cast<double>(period_ps), sc_core::SC_PS),
      edge_("edge"),
      units_(std::move(units)) {
  SC_HAS_PROCESS(EngineClock);
  SC_METHOD(tick);
  sensitive << edge_;
  dont_initialize();
}

void EngineClock::open() {
  open_ = true;
  edge_.cancel();
  edge_.notify(period_);
}

void EngineClock::tick() {
  units_();
  if (open_) edge_.notify(period_);
}

}  // namespace hvp::vp::engine
