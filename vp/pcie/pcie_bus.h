#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <systemc>
#include <vector>

#include <tlm_utils/multi_passthrough_initiator_socket.h>
#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

#include "models/link/interconnect.h"
#include "vp/bus/bus_meter.h"
#include "vp/bus/bus_settings.h"
#include "vp/fidelity.h"
#include "vp/frame/frame_tag.h"
#include "vp/frame/ledger.h"
#include "vp/latency_draws.h"
#include "vp/pcie/pcie_timing.h"
#include "vp/pcie/posted_path.h"

namespace hvp::vp {

// A PCI Express link between the host's root port and one board. Every transaction synchronises.
//
// Writes are posted, both ways: the processor goes on when it can store the next packet
// (write_gap), the board when its last packet has left; a write reaches its target when it arrives
// there. The processor's blocks leave in packets of write_combining_bytes. It reads single words,
// so that a block is as many round trips. A read stays behind the writes of its side; its answer is
// the target's contents when the request arrives, and stays behind what the other side has written
// before (PCIe 5.0 §2.4.1). INTx is a message behind the board's writes, and so is MSI, a write to
// kMessageAddress.
//
// `loosely-timed` and `approximately-timed` differ in PcieTiming. An access to an address that no
// target claims is an unsupported request: a read gets an address error and all ones, a write has
// no answer.
class PcieBus : public sc_core::sc_module, public InterruptIf {
 public:
  PcieBus(const sc_core::sc_module_name& name, const link::Pcie& link, Timing level,
          Ledger& ledger);
  // `seed` is for the draws of [bus.pcie.root_complex_latencies].
  PcieBus(const sc_core::sc_module_name& name, const PcieSettings& settings, Timing level,
          Ledger& ledger, std::int64_t seed);

  tlm_utils::simple_target_socket<PcieBus> from_host;
  // The board's own transactions; unbound if it has none. One read at a time: others wait.
  tlm_utils::simple_target_socket_optional<PcieBus> from_board;
  // The receiver of INTx messages.
  sc_core::sc_port<InterruptIf, 1, sc_core::SC_ZERO_OR_MORE_BOUND> interrupt_line;

  // As in PciBus.
  void attach(tlm::tlm_target_socket<>& target, std::uint64_t base, std::uint64_t size);
  void attach_memory(tlm::tlm_target_socket<>& memory);
  void drain_to_board();
  void drain_to_host();

  // InterruptIf: the board's line, whose changes become messages.
  void interrupt(const Tag& tag) override;
  void lowered() override;

  // BusUse::busy is the time of the data's direction.
  BusUses uses() const { return {uses_.begin(), uses_.end()}; }
  // The busy time of the direction from this side, for all packets: a read has requests in one
  // direction and completions in the other.
  Picoseconds busy(link::PcieSide sender) const { return timing_.busy(sender); }

 private:
  // A cache for the cost of a transaction of the last number of bytes, because evaluating the
  // formulas takes as long as the rest of a register access.
  class Remembered {
   public:
    template <class Formula>
    const link::Cost& of(std::int64_t bytes, const Formula& formula) {
      if (bytes != bytes_) cost_ = formula(bytes);
      bytes_ = bytes;
      return cost_;
    }

   private:
    std::int64_t bytes_ = -1;
    link::Cost cost_;
  };
  struct Window {
    std::uint64_t base;
    std::uint64_t size;
    int target;
  };
  enum User { kProcessor, kBoard, kUsers };
  // The effect [bus.pcie.root_complex_latencies] for the board's current read.
  struct RootComplex : link::CompleterTimes {
    RootComplex(const link::RootComplexLatencies& latencies, std::int64_t seed)
        : draws(latencies.drawn(), seed, "bus.pcie.root_complex_latencies") {}
    Picoseconds ps(std::int64_t request) const override {
      return draws.ps(frame, first + static_cast<std::uint32_t>(request));
    }
    LatencyDraws draws;
    std::int64_t frame = -1;
    std::uint32_t first = 0;
  };

  void from_host_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  void from_board_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  const link::Cost& processor_write_cost(std::int64_t bytes);
  const link::Cost& processor_read_cost(std::int64_t bytes);
  void processor_write(tlm::tlm_generic_payload& transaction);
  void processor_read(tlm::tlm_generic_payload& transaction);
  void board_write(tlm::tlm_generic_payload& transaction);
  void board_read(tlm::tlm_generic_payload& transaction);
  const link::CompleterTimes* root_complex_times(std::int64_t frame, std::int64_t bytes);
  void reach_target(tlm::tlm_generic_payload& transaction);
  void reach_memory(tlm::tlm_generic_payload& transaction);
  void has_left(PostedWrite& write);
  void arrived_at_board(PostedWrite& write);
  void arrived_at_host(PostedWrite& write);
  void account(Tag& tag, Phase phase, Picoseconds began, Picoseconds alone);
  void count(User user, const link::Cost& cost, std::int64_t bytes);

  link::Pcie link_;
  link::PcieInterconnect formulas_;
  Remembered write_cost_;
  Remembered read_cost_;
  bool untimed_;
  Picoseconds to_port_;    // from the processor to the root port
  Picoseconds from_port_;  // and back
  Ledger& ledger_;
  PcieTiming timing_;
  PostedPath down_;
  PostedPath up_;
  PostedTransaction to_target_;
  PostedTransaction to_host_;
  tlm_utils::multi_passthrough_initiator_socket<PcieBus> to_targets_;
  tlm_utils::simple_initiator_socket_optional<PcieBus> to_memory_;
  bool has_memory_ = false;
  std::vector<Window> windows_;
  bool processor_reads_ = false;
  bool board_reads_ = false;
  sc_core::sc_event read_over_;
  std::array<BusUse, kUsers> uses_;
  std::optional<RootComplex> root_complex_;
};

// The decoder of the processor's addresses for a board with a PCI Express link of its own: one
// window goes to the link, everything else to the PCI bus behind the same chipset. It takes no
// time, because the figures of both buses include the processor's latency.
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
