#pragma once

#include <cstdint>
#include <systemc>

#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

namespace hvp::vp {

// The processor's addresses, where a board has a PCI Express link of its own: one window goes to
// the link, everything else to the PCI bus behind the same chipset. It takes no time: both have the
// processor's way to them in their own figures.
class HostBridge : public sc_core::sc_module {
 public:
  HostBridge(const sc_core::sc_module_name& name, std::uint64_t link_base, std::uint64_t link_size);

  tlm_utils::simple_target_socket<HostBridge> from_host;
  tlm_utils::simple_initiator_socket<HostBridge> to_link;
  tlm_utils::simple_initiator_socket<HostBridge> to_bus;

 private:
  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);

  std::uint64_t link_base_;
  std::uint64_t link_size_;
};

}  // namespace hvp::vp
