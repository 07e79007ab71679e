#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <systemc>

#include "models/link/pcie.h"
#include "models/link/pcie_link.h"
#include "vp/fidelity.h"
#include "vp/frame/ledger.h"

namespace hvp::vp {

// The timing of packets on a PCI Express link, in the process of their sender.
//
// Loosely timed, it uses link::Pcie's formulas, and each direction of the link is taken until the
// last packet of its user has left. Approximately timed, it is link::PcieLink: packet by packet,
// with credits, tags and link layer. `untimed` takes no time. The caller makes sure that each
// sender's transactions follow each other.
class PcieTiming : private link::PcieLink::Observer {
 public:
  enum Sender : int { kProcessorWrites, kProcessorReads, kBoardWrites, kBoardReads, kSenders };

  // The purpose of a sender's packets.
  struct Errand {
    Phase phase = Phase::message;
    std::int64_t frame = -1;
  };

  PcieTiming(const link::Pcie& link, Timing level, const Ledger& ledger);
  PcieTiming(const PcieTiming&) = delete;
  PcieTiming& operator=(const PcieTiming&) = delete;

  // Sends a write of this number of bytes, or a message for zero bytes. Returns when its last
  // packet has left, with the time of its arrival at the other side.
  Picoseconds send(Sender sender, std::int64_t bytes, Errand errand);
  // Sends a read, also of more bytes than one request may have. Returns when its last request is at
  // the other side. `times` are the completer's latencies; null: the link's constant.
  void ask(Sender sender, std::int64_t bytes, Errand errand,
           const link::CompleterTimes* times = nullptr);
  // Follows ask() and returns when the read's last completion is back.
  void await_answer(Sender sender);

  // The busy time so far of the direction from this side. Loosely timed, each transaction counts
  // its packets with their share of the link layer's when it begins; approximately timed, every
  // packet counts when it has left.
  Picoseconds busy(link::PcieSide sender) const;

 private:
  static link::PcieSide side(Sender sender) {
    return sender == kProcessorWrites || sender == kProcessorReads ? link::PcieSide::root
                                                                   : link::PcieSide::device;
  }
  static std::size_t index(link::PcieSide side) { return side == link::PcieSide::root ? 0 : 1; }
  Picoseconds& free_at(link::PcieSide side) { return free_at_[index(side)]; }
  Picoseconds send_by_formula(Sender sender, std::int64_t bytes);
  void ask_by_formula(Sender sender, std::int64_t bytes, const link::CompleterTimes* times);
  void until_sent(Sender sender);
  void sent(link::PcieSide sender, int initiator, Picoseconds start, Picoseconds end) override;

  link::Pcie link_;
  bool untimed_;
  const Ledger& ledger_;
  std::array<Errand, kSenders> errands_;
  std::array<Picoseconds, 2> free_at_{};          // loosely timed; by the sending side
  std::array<Picoseconds, 2> busy_{};             // likewise
  std::array<Picoseconds, kSenders> answered_{};  // loosely timed
  std::optional<link::PcieLink> packets_;         // approximately timed
  sc_core::sc_event changed_;                     // the basis of the forecasts has changed
};

}  // namespace hvp::vp
