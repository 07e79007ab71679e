#include "vp/pci/other_masters.h"

#include "vp/frame/frame_tag.h"

namespace hvp::vp {

TrafficMaster::TrafficMaster(const sc_core::sc_module_name& name, const BusTraffic& traffic,
                             PciBus& bus, PciBus::Master master)
    : sc_module(name), traffic_(traffic), bus_(bus), master_(master) {
  SC_HAS_PROCESS(TrafficMaster);
  SC_THREAD(run);
}

void TrafficMaster::run() {
  for (std::int64_t block = 0;; ++block) {
    const Picoseconds due = traffic_.start() + block * traffic_.period();
    if (now_ps() > due) {
      ++left_out_;
      continue;
    }
    wait(to_sc_time(due - now_ps()));
    bus_.move(master_, traffic_.direction, traffic_.bytes);
    ++blocks_;
  }
}

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
