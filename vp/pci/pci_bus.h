#pragma once

#include <cstdint>
#include <systemc>
#include <vector>

#include <tlm_utils/multi_passthrough_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

#include "models/link/pci.h"
#include "vp/frame_tag.h"
#include "vp/ledger.h"

namespace hvp::vp {

// The PCI bus, loosely timed: every transaction synchronises, waits until the bus is free, takes
// what link::Pci says and reaches its target when its last data phase is over. Simulated time
// therefore never depends on a quantum.
//
// A transaction that no target claims ends in a master abort: TLM_ADDRESS_ERROR_RESPONSE and, for
// a read, all ones (PCI 3.0 §3.3.3.1). `untimed` takes no time at all.
class PciBus : public sc_core::sc_module {
 public:
  PciBus(const sc_core::sc_module_name& name, const link::Pci& model, bool untimed, Ledger& ledger);

  tlm_utils::simple_target_socket<PciBus> from_host;

  // Claims [base, base + size) for a target; before the simulation starts. Addresses that the
  // target sees start at zero.
  void attach(tlm::tlm_target_socket<>& target, std::uint64_t base, std::uint64_t size);

  std::int64_t bytes_moved() const { return bytes_; }
  std::int64_t transactions() const { return transactions_; }
  Picoseconds busy() const { return busy_; }

 private:
  struct Window {
    std::uint64_t base;
    std::uint64_t size;
    int target;  // in the order of binding
  };

  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  Window* claim(std::uint64_t address);

  link::Pci model_;
  bool untimed_;
  Ledger& ledger_;
  tlm_utils::multi_passthrough_initiator_socket<PciBus> to_targets_;
  std::vector<Window> windows_;
  Picoseconds free_at_ = 0;
  std::int64_t bytes_ = 0;
  std::int64_t transactions_ = 0;
  Picoseconds busy_ = 0;
};

}  // namespace hvp::vp
