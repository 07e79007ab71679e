#pragma once

#include <cstdint>
#include <optional>

#include "models/config/figures.h"
#include "vp/bus/bus_use.h"

namespace hvp::results {

// How much of the servo loop's time a bus was taken.
struct BusLoad {
  double share = 0;
  double worst_share = 0;  // from one frame's solution to the next one's
  vp::Picoseconds time = 0;
  vp::BusUses uses;  // of every initiator

  double share_of(const vp::BusUse& use) const {
    return time > 0 ? static_cast<double>(use.busy) / static_cast<double>(time) : 0;
  }
};

// The buses' figures of a run: the table `bus`.
struct BusFigures {
  std::int64_t transactions = 0;
  std::int64_t bytes = 0;
  vp::Picoseconds busy = 0;
  BusLoad load;
  // With [bus.pcie]; the initiators are in both, with the direction of their data.
  struct Link {
    BusLoad to_board;
    BusLoad to_host;
  };
  std::optional<Link> link;

  void report(config::Figures& f) const;
};

}  // namespace hvp::results
