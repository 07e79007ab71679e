#pragma once

#include <functional>

#include "vp/bus/bus_use.h"
#include "vp/frame/frame_tag.h"
#include "vp/frame/observer.h"

namespace hvp::vp {

// How much of the time a bus was taken while the servo loop ran: set-up, which loads K, lies before
// it. Looks once a frame and allocates nothing in the loop.
class BusMeter : public FrameObserver {
 public:
  // All since the simulation began. `busy` is the sum over the initiators, of a link that of one
  // direction; `until_now` is what of it lies before the call, to the picosecond.
  struct Bus {
    std::function<Picoseconds()> busy;
    std::function<Picoseconds()> until_now;
    std::function<BusUses()> uses;
  };

  explicit BusMeter(Bus bus) : bus_(std::move(bus)) {}

  void begun() override;
  void solved(const Frame& frame, const Solution& solution) override;
  // After the last frame.
  void ended();

  // Of the servo loop. A transaction under way at its end counts as far as the bus has counted it.
  double share() const;
  // From one frame's solution to the next one's, where that was most; no less than share().
  double worst_share() const { return worst_share_; }
  Picoseconds time() const { return end_ - begin_; }
  // Since the loop began; of every initiator.
  const BusUses& uses() const { return uses_; }

 private:
  Bus bus_;
  BusUses uses_;  // until ended(): when the loop began
  Picoseconds begin_ = 0;
  Picoseconds end_ = 0;
  Picoseconds last_time_ = -1;  // of the last solution
  Picoseconds last_busy_ = 0;
  Picoseconds busy_ = 0;
  double worst_share_ = 0;
};

}  // namespace hvp::vp
