#pragma once

#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "vp/frame/frame.h"
#include "vp/frame/ledger.h"

namespace hvp::vp {

// The use of a bus by one initiator since the simulation began, including set-up.
struct BusUse {
  std::string_view name;  // processor, board, traffic, graphics
  Picoseconds busy = 0;   // time that the bus, or the initiator's direction of a link, was taken
  std::int64_t bytes = 0;
  std::int64_t transactions = 0;
};

// The uses of all initiators of a bus, including idle ones.
using BusUses = std::vector<BusUse>;

// The share of time in which a bus was taken while the servo loop ran; set-up, which loads K, comes
// before it. Samples once a frame and allocates nothing in the loop.
class BusMeter : public FrameObserver {
 public:
  // All counts are since the simulation began. `busy` is the sum over the initiators, and for a
  // link that of one direction; `until_now` is its part before the call, exact to the picosecond,
  // as is `uses_until_now` of each initiator.
  struct Bus {
    std::function<Picoseconds()> busy;
    std::function<Picoseconds()> until_now;
    std::function<BusUses()> uses;
    std::function<BusUses()> uses_until_now;
  };

  explicit BusMeter(Bus bus) : bus_(std::move(bus)) {}

  void begun() override;
  void solved(const Frame& frame, const Solution& solution) override;
  // To be called after the last frame.
  void ended();

  // The share in the servo loop. A transaction under way at its end counts as far as the bus has
  // counted it.
  double share() const;
  // The largest share between two successive frames' solutions; no less than share().
  double worst_share() const { return worst_share_; }
  Picoseconds time() const { return end_ - begin_; }
  // The use since the loop began, by initiator.
  const BusUses& uses() const { return uses_; }

 private:
  Bus bus_;
  BusUses uses_;  // until ended() the use at the loop's begin
  Picoseconds begin_ = 0;
  Picoseconds end_ = 0;
  Picoseconds last_time_ = -1;  // the last solution's
  Picoseconds last_busy_ = 0;
  Picoseconds busy_ = 0;
  double worst_share_ = 0;
};

}  // namespace hvp::vp
