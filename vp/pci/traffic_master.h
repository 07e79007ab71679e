#pragma once

#include <systemc>

#include "vp/pci/bus_settings.h"
#include "vp/pci/pci_bus.h"

namespace hvp::vp {

// A board that is master of the bus once a period. Whom it moves bytes from or to is outside the
// platform: it takes the bus' time and nothing else.
class TrafficMaster : public sc_core::sc_module {
 public:
  // `master` is its number on the bus.
  TrafficMaster(const sc_core::sc_module_name& name, const BusTraffic& traffic, PciBus& bus,
                PciBus::Master master = PciBus::kTraffic);

  std::int64_t blocks() const { return blocks_; }
  std::int64_t left_out() const { return left_out_; }

 private:
  void run();

  BusTraffic traffic_;
  PciBus& bus_;
  PciBus::Master master_;
  std::int64_t blocks_ = 0;
  std::int64_t left_out_ = 0;
};

}  // namespace hvp::vp
