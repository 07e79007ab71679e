#include "vp/pcie/host_bridge.h"

namespace hvp::vp {

HostBridge::HostBridge(const sc_core::sc_module_name& name, std::uint64_t link_base,
                       std::uint64_t link_size)
    : sc_module(name),
      from_host("from_host"),
      to_link("to_link"),
      to_bus("to_bus"),
      link_base_(link_base),
      link_size_(link_size) {
  from_host.register_b_transport(this, &HostBridge::b_transport);
}

void HostBridge::b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
  const std::uint64_t address = transaction.get_address();
  if (address >= link_base_ && address - link_base_ < link_size_) {
    to_link->b_transport(transaction, delay);
  } else {
    to_bus->b_transport(transaction, delay);
  }
}

}  // namespace hvp::vp
