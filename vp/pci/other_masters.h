#pragma once

#include <cstdint>
#include <systemc>

#include "vp/bus/bus_settings.h"
#include "vp/pci/pci_bus.h"

namespace hvp::vp {

// A board that is bus master once a period. The source or destination of its bytes is outside the
// platform: it only takes the bus' time.
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

// A graphics card on the PCI bus that fetches a picture's data as its master, each time that
// drawing begins. A picture that begins while the last one is still being fetched is left out.
class GraphicsMaster : public sc_core::sc_module {
 public:
  GraphicsMaster(const sc_core::sc_module_name& name, std::int64_t picture_bytes, PciBus& bus);

  sc_core::sc_event& drawing() { return drawing_; }
  std::int64_t pictures() const { return pictures_; }

 private:
  void run();

  std::int64_t bytes_;
  PciBus& bus_;
  sc_core::sc_event drawing_;
  std::int64_t pictures_ = 0;
};

}  // namespace hvp::vp
