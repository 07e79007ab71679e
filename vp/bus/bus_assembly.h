#pragma once

#include <cstdint>
#include <memory>
#include <tlm>

#include "vp/fidelity.h"
#include "vp/frame/ledger.h"
#include "vp/pci/bus_settings.h"
#include "vp/pci/graphics_master.h"
#include "vp/pci/pci_bus.h"
#include "vp/pci/traffic_master.h"
#include "vp/pcie/host_bridge.h"
#include "vp/pcie/pcie_bus.h"

namespace hvp::vp {

// The ways between the processor, its boards and its memory: the PCI bus with its other masters,
// and with [bus.pcie] a link that the solver board has to itself, behind the same chipset.
class BusAssembly {
 public:
  // `seed`: of what is drawn; `vertices`: of a picture, for [bus.graphics_traffic].
  BusAssembly(const BusSettings& settings, Timing level, std::int64_t seed, std::int64_t vertices,
              Ledger& ledger);

  // Where the processor's accesses go in.
  tlm::tlm_target_socket<>& from_host();
  // Calls it with the bus that the solver board is on: PciBus or PcieBus.
  template <class Connect>
  void at_solver_board(const Connect& connect) {
    if (pcie_ != nullptr) {
      connect(*pcie_);
    } else {
      connect(pci_);
    }
  }
  // Where the solver board's interrupt line ends so that the host hears of it: the host itself, or
  // the link, which makes messages of it.
  InterruptIf& line_to(InterruptIf& host);

  // Waits until nothing that was posted is under way; in the caller's process.
  void drain();

  PciBus& pci() { return pci_; }
  const PciBus& pci() const { return pci_; }
  // Null without their effects.
  const PcieBus* pcie() const { return pcie_.get(); }
  GraphicsMaster* graphics() const { return graphics_.get(); }
  const TrafficMaster* traffic() const { return traffic_.get(); }

 private:
  PciBus pci_;
  std::unique_ptr<TrafficMaster> traffic_;
  std::unique_ptr<GraphicsMaster> graphics_;
  std::unique_ptr<HostBridge> bridge_;
  std::unique_ptr<PcieBus> pcie_;
};

}  // namespace hvp::vp
