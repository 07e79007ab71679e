#pragma once

#include <cstdint>
#include <memory>
#include <systemc>
#include <vector>

#include <tlm_utils/multi_passthrough_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

#include "models/link/pci.h"
#include "models/link/pci_arbiter.h"
#include "vp/fidelity.h"
#include "vp/frame_tag.h"
#include "vp/ledger.h"
#include "vp/pci/bus_settings.h"

namespace hvp::vp {

// The PCI bus. Every transaction synchronises, so that simulated time never depends on a quantum,
// and reaches its target when its last data phase is over.
//
// Loosely timed, a transaction waits until the bus is free, takes what link::Pci says and is served
// whole. Approximately timed, it takes the processor's way to the bus and then what
// link::PciArbiter says: bursts, clock edges, other masters. `untimed` takes no time at all.
//
// A transaction that no target claims ends in a master abort: TLM_ADDRESS_ERROR_RESPONSE and, for
// a read, all ones (PCI 3.0 §3.3.3.1).
class PciBus : public sc_core::sc_module {
 public:
  // Masters of the approximately-timed bus: the processor's bridge is number 0.
  static constexpr int kMasters = 2;
  static constexpr int kProcessor = 0;

  PciBus(const sc_core::sc_module_name& name, const link::Pci& model, bool untimed, Ledger& ledger);
  PciBus(const sc_core::sc_module_name& name, const BusSettings& settings, Timing level,
         Ledger& ledger);

  tlm_utils::simple_target_socket<PciBus> from_host;

  // Claims [base, base + size) for a target; before the simulation starts. Addresses that the
  // target sees start at zero.
  void attach(tlm::tlm_target_socket<>& target, std::uint64_t base, std::uint64_t size);

  // A master's block on the approximately-timed bus, in the caller's process; returns when the bus
  // is released. One at a time a master.
  void move(int master, link::Direction direction, std::int64_t bytes);

  // Of the processor's transactions.
  std::int64_t bytes_moved() const { return bytes_; }
  std::int64_t transactions() const { return transactions_; }
  // Time that they took; approximately timed, that anybody owned the bus.
  Picoseconds busy() const;

 private:
  struct Window {
    std::uint64_t base;
    std::uint64_t size;
    int target;  // in the order of binding
  };

  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  void serve_whole(Tag& tag, Phase phase, Picoseconds time);
  void serve_in_bursts(Tag& tag, Phase phase, link::Direction direction, std::int64_t bytes);
  void hold(Picoseconds time);
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

  std::unique_ptr<link::PciArbiter> arbiter_;  // approximately timed
  sc_core::sc_event changed_;                  // what forecasts rest on
  bool processor_served_ = false;
};

}  // namespace hvp::vp
