#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <systemc>
#include <vector>

#include <tlm_utils/multi_passthrough_initiator_socket.h>
#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

#include "models/link/pci.h"
#include "models/link/pci_arbiter.h"
#include "vp/bus/bus_meter.h"
#include "vp/bus/bus_settings.h"
#include "vp/bus/bus_transaction.h"
#include "vp/fidelity.h"
#include "vp/frame/frame_tag.h"
#include "vp/frame/ledger.h"
#include "vp/latency_draws.h"

namespace hvp::vp {

// The PCI bus. Every transaction synchronises, so that simulated time never depends on a quantum,
// and reaches its target when its last data phase is over.
//
// Loosely timed, a transaction waits until the bus is free, takes what link::Pci says and is served
// whole. Approximately timed, it takes the processor's way to the bus and then what
// link::PciArbiter says: bursts, clock edges, other masters. `untimed` takes no time. A board's own
// transactions take the wire's time alone, without a processor's latency.
//
// With [bus.posted_writes] the processor goes on when the bridge has taken its write, and the
// board's writes are in memory later than on the bus; a read stays behind the writes before it; an
// interrupt line does not.
//
// A transaction that no target claims ends in a master abort: TLM_ADDRESS_ERROR_RESPONSE and, for a
// read, all ones (PCI 3.0 §3.3.3.1).
class PciBus : public sc_core::sc_module, private link::PciArbiter::Observer {
 public:
  // Masters of the bus: the processor's bridge, [bus.traffic], the board, [bus.graphics_traffic].
  enum Master : int { kProcessor, kTraffic, kBoard, kGraphics, kMasters };

  PciBus(const sc_core::sc_module_name& name, const link::Pci& model, bool untimed, Ledger& ledger);
  // `seed` is for the draws of [bus.read_latencies].
  PciBus(const sc_core::sc_module_name& name, const BusSettings& settings, Timing level,
         Ledger& ledger, std::int64_t seed = 1);

  tlm_utils::simple_target_socket<PciBus> from_host;
  // The board's transactions as bus master; unbound if it is not one. One transaction at a time:
  // others wait.
  tlm_utils::simple_target_socket_optional<PciBus> from_board;

  // Claims [base, base + size) for a target. To be called before the simulation starts. The
  // target's addresses start at zero.
  void attach(tlm::tlm_target_socket<>& target, std::uint64_t base, std::uint64_t size);
  // The target of the board's transactions, with unchanged addresses.
  void attach_memory(tlm::tlm_target_socket<>& memory);

  // Moves a master's block on the approximately-timed bus, in the caller's process; returns when
  // the bus is released. One at a time for each master.
  void move(Master master, link::Direction direction, std::int64_t bytes);

  // Wait in the caller's process until no posted write is under way in this direction.
  void drain_to_board();
  void drain_to_host();

  // The processor's bytes and transactions.
  std::int64_t bytes_moved() const { return uses_.front().bytes; }
  std::int64_t transactions() const { return uses_.front().transactions; }
  // The time of all transactions; approximately timed, the time in which the bus was owned.
  Picoseconds busy() const;
  // The part of the busy time before now, including transactions under way. busy() counts a
  // transaction when it begins (loosely timed), or a tenure when it has been followed to its end.
  Picoseconds busy_until_now() const;
  BusUses uses() const;
  // Likewise the part of each master's before now.
  BusUses uses_until_now() const;

 private:
  struct Window {
    std::uint64_t base;
    std::uint64_t size;
    int target;  // in the order of binding
  };
  // A transaction's time: on the way to the bus, and on it.
  struct Service {
    Master master;
    link::Direction direction;
    std::int64_t bytes;
    Picoseconds latency;
    Phase phase;
    std::int64_t frame;
  };
  // The purpose of a master's bus tenure.
  struct Errand {
    Phase phase = Phase::dma_write;
    std::int64_t frame = -1;
  };
  struct Posting {
    Posting(const PostedWriteSettings& with, std::size_t places)
        : settings(with), down(with.places()), up(places) {}
    PostedWriteSettings settings;
    PostedWrites down;  // from the processor
    PostedWrites up;    // from the board, to memory
    PostedTransaction to_target;
    PostedTransaction to_memory;
    sc_core::sc_event changed;
  };

  void from_host_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  void from_board_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  void reach_target(tlm::tlm_generic_payload& transaction);
  void reach_memory(tlm::tlm_generic_payload& transaction);
  Picoseconds way_to_bus(link::Direction direction) const;
  Picoseconds way_to_bus(tlm::tlm_generic_payload& transaction);
  Picoseconds alone(const Service& service) const;
  void occupy(const Service& service, std::int64_t first = 0);
  void take_turn(Master master);
  void occupy_whole(const Service& service, std::int64_t first);
  void occupy_in_bursts(const Service& service, std::int64_t first);
  void request_and_wait(Master master, link::Direction direction, std::int64_t bytes);
  void account(Tag& tag, Phase phase, Picoseconds began, Picoseconds alone);

  void post(tlm::tlm_generic_payload& transaction);
  void first_has_left();
  void drain_to_targets();
  void drain_to_memory();
  void post_to_memory(tlm::tlm_generic_payload& transaction, const Tag& tag);
  void wait_for_posted(PostedWrites Posting::*writes);
  void keep_bus(Master master, Picoseconds time);
  void owned(int master, Picoseconds start, Picoseconds end) override;
  BusUse& use(Master master) { return uses_[static_cast<std::size_t>(master)]; }
  Window* claim(std::uint64_t address);

  link::Pci model_;
  bool untimed_;
  Ledger& ledger_;
  tlm_utils::multi_passthrough_initiator_socket<PciBus> to_targets_;
  tlm_utils::simple_initiator_socket_optional<PciBus> to_memory_;
  std::vector<Window> windows_;
  bool has_memory_ = false;
  Picoseconds free_at_ = 0;
  std::array<int, kMasters> asking_{};  // loosely timed
  std::array<BusUse, kMasters> uses_;
  int last_user_ = 0;  // of the loosely-timed bus
  std::array<Errand, kMasters> errands_;

  std::unique_ptr<link::PciArbiter> arbiter_;  // approximately timed
  sc_core::sc_event changed_;                  // the basis of the forecasts has changed
  std::array<bool, kMasters> served_{};        // approximately timed
  std::unique_ptr<Posting> posting_;           // the effect [bus.posted_writes]
  std::optional<LatencyDraws> reads_;          // the effect [bus.read_latencies]
};

}  // namespace hvp::vp
