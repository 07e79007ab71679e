#include "vp/pci/graphics_master.h"

namespace hvp::vp {

GraphicsMaster::GraphicsMaster(const sc_core::sc_module_name& name, std::int64_t picture_bytes,
                               PciBus& bus)
    : sc_module(name), bytes_(picture_bytes), bus_(bus), drawing_("drawing") {
  SC_HAS_PROCESS(GraphicsMaster);
  SC_THREAD(run);
}

void GraphicsMaster::run() {
  while (true) {
    wait(drawing_);
    bus_.move(PciBus::kGraphics, link::Direction::read, bytes_);
    ++pictures_;
  }
}

}  // namespace hvp::vp
