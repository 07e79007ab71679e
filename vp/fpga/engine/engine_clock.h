#pragma once

#include <cstdint>
#include <systemc>

namespace hvp::vp::engine {

// The engine's clock behind its gate: edges come only while somebody has work, so that an idle
// engine costs nothing.
class EngineClock : public sc_core::sc_module {
 public:
  EngineClock(const sc_core::sc_module_name& name, std::int64_t period_ps);

  const sc_core::sc_event& edge() const { return edge_; }
  // The first edge comes a period from now, also where the gate was open.
  void open();
  void close() {
    open_ = false;
    edge_.cancel();
  }
  bool is_open() const { return open_; }
  const sc_core::sc_time& period() const { return period_; }

 private:
  void tick();

  sc_core::sc_time period_;
  sc_core::sc_event edge_;
  bool open_ = false;
};

}  // namespace hvp::vp::engine
