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

// The time that packets take on a PCI Express link, in the process of whoever sends them.
//
// Loosely timed it is link::Pcie's formulas, each direction of the link taken until the last packet
// of what uses it has left. Approximately timed it is link::PcieLink: packet by packet, with
// credits, tags and link layer. `untimed` takes none. What each sender sends goes one after the
// other; that is the caller's to see to.
class PcieTiming : private link::PcieLink::Observer {
 public:
  enum Sender : int { kProcessorWrites, kProcessorReads, kBoardWrites, kBoardReads, kSenders };

  // What a sender has packets on the link for.
  struct Errand {
    Phase phase = Phase::message;
    std::int64_t frame = -1;
  };

  PcieTiming(const link::Pcie& link, Timing level, const Ledger& ledger);
  PcieTiming(const PcieTiming&) = delete;
  PcieTiming& operator=(const PcieTiming&) = delete;

  // A write of so many bytes, or, without, a message. Returns when its last packet has left, with
  // the time of its arrival at the other side.
  Picoseconds send(Sender sender, std::int64_t bytes, Errand errand);
  // A read, as large as a request may be or larger. Returns when its last request is at the other
  // side. `times`: of what is read, until the answer is there; null: the link's constant.
  void ask(Sender sender, std::int64_t bytes, Errand errand,
           const link::CompleterTimes* times = nullptr);
  // Behind ask(): returns when its last completion is back.
  void await_answer(Sender sender);

  // How long the direction from this side has been taken so far. Loosely timed by each
  // transaction's packets, when it begins, with their share of the link layer's; approximately
  // timed by every packet that has left.
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
  sc_core::sc_event changed_;                     // what forecasts rest on
};

}  // namespace hvp::vp
