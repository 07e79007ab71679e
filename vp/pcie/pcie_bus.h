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
#include "vp/bus/bus_use.h"
#include "vp/fidelity.h"
#include "vp/frame/frame_tag.h"
#include "vp/frame/ledger.h"
#include "vp/latency_draws.h"
#include "vp/pci/bus_settings.h"
#include "vp/pcie/pcie_timing.h"
#include "vp/pcie/posted_path.h"

namespace hvp::vp {

// A PCI Express link between the host's root port and one board. Every transaction synchronises.
//
// Writes are posted, both ways: the processor goes on when it can store the next packet
// (write_gap), the board when its last packet has left; a write reaches its target when it arrives
// there. The processor's blocks leave in packets of write_combining_bytes. Its reads are of a word
// each: a block is as many round trips. A read is behind the writes of its side, is answered with
// what its target holds when the request arrives, and its answer is behind what the other side has
// written before that (PCIe 5.0 §2.4.1). INTx is a message behind the board's writes, and so is
// MSI, a write to kMessageAddress.
//
// `loosely-timed` and `approximately-timed` differ in PcieTiming. An address that nobody claims is
// an unsupported request: an address error and all ones for a read, silence for a write.
class PcieBus : public sc_core::sc_module, public InterruptIf {
 public:
  PcieBus(const sc_core::sc_module_name& name, const link::Pcie& link, Timing level,
          Ledger& ledger);
  // `seed`: of what [bus.pcie.root_complex_latencies] draws.
  PcieBus(const sc_core::sc_module_name& name, const PcieSettings& settings, Timing level,
          Ledger& ledger, std::int64_t seed);

  tlm_utils::simple_target_socket<PcieBus> from_host;
  // The board's own transactions; unbound where it has none. One read at a time: others wait.
  tlm_utils::simple_target_socket_optional<PcieBus> from_board;
  // Where INTx messages end.
  sc_core::sc_port<InterruptIf, 1, sc_core::SC_ZERO_OR_MORE_BOUND> interrupt_line;

  // As PciBus.
  void attach(tlm::tlm_target_socket<>& target, std::uint64_t base, std::uint64_t size);
  void attach_memory(tlm::tlm_target_socket<>& memory);
  void drain();

  // InterruptIf: the board's line, which becomes messages.
  void interrupt(const Tag& tag) override;
  void lowered() override;

  // Busy: the direction of the data.
  BusUses uses() const { return {uses_.begin(), uses_.end()}; }
  // The direction from this side, whoever's packets they are: a read has requests in one and
  // completions in the other.
  Picoseconds busy(link::PcieSide sender) const { return timing_.busy(sender); }

 private:
  // What a transaction of so many bytes costs, worked out anew where it is another number than the
  // time before: the formulas take as long as a register's access does otherwise.
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
  // The effect [bus.pcie.root_complex_latencies]: of the board's read that is under way.
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

}  // namespace hvp::vp
