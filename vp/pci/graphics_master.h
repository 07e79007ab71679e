#pragma once

#include <cstdint>
#include <systemc>

#include "vp/pci/pci_bus.h"

namespace hvp::vp {

// A graphics card on the PCI bus that fetches a picture's data as its master, each time that
// somebody begins to draw. A picture that begins while the last one is still being fetched is left
// out.
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
