#include "vp/bus/bus_assembly.h"

#include "vp/bus/memory_map.h"
#include "vp/fpga/register_table.h"

namespace hvp::vp {

BusAssembly::BusAssembly(const BusSettings& settings, Timing level, std::int64_t seed,
                         std::int64_t vertices, Ledger& ledger)
    : pci_("bus", settings, level, ledger, seed) {
  if (settings.traffic) {
    traffic_ = std::make_unique<TrafficMaster>("traffic", *settings.traffic, pci_);
  }
  if (settings.graphics_traffic) {
    graphics_ = std::make_unique<GraphicsMaster>(
        "graphics", settings.graphics_traffic->picture_bytes(vertices), pci_);
  }
  if (!settings.pcie) return;
  bridge_ = std::make_unique<HostBridge>("bridge", kSolverBase, kBarBytes);
  pcie_ = std::make_unique<PcieBus>("pcie", *settings.pcie, level, ledger, seed);
  bridge_->to_link.bind(pcie_->from_host);
  bridge_->to_bus.bind(pci_.from_host);
}

tlm::tlm_target_socket<>& BusAssembly::from_host() {
  if (bridge_ != nullptr) return bridge_->from_host;
  return pci_.from_host;
}

InterruptIf& BusAssembly::line_to(InterruptIf& host) {
  if (pcie_ == nullptr) return host;
  pcie_->interrupt_line.bind(host);
  return *pcie_;
}

void BusAssembly::drain() {
  pci_.drain();
  if (pcie_ != nullptr) pcie_->drain();
}

}  // namespace hvp::vp
