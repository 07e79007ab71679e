#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "models/collision/contact.h"
#include "models/plant/daq.h"
#include "vp/device/daq_board.h"
#include "vp/host/board_access.h"

namespace hvp::vp {

// The servo process' accesses to the data acquisition board: all probes in one block each way.
class DaqDriver {
 public:
  DaqDriver(BoardAccess& access, std::size_t probes) : access_(access), counts_(3 * probes) {}

  // Latches the tips' positions and reads them, m.
  void read_positions(std::span<collision::Touch> touches) {
    const std::uint32_t latch = 1;
    access_.write(kDaqBase + DaqBoard::kLatch, &latch, sizeof(latch));
    access_.read(kDaqBase + DaqBoard::kPosition, counts_.data(), bytes());
    std::size_t next = 0;
    for (collision::Touch& touch : touches) {
      for (int i = 0; i < 3; ++i) touch.tip[i] = plant::kPosition.to_value(counts_[next++]);
    }
  }

  // The devices push back with what their users exert on the body. False where a register had no
  // room for it.
  bool write_forces(std::span<const collision::Touch> touches) {
    bool fits = true;
    std::size_t next = 0;
    for (const collision::Touch& touch : touches) {
      for (int i = 0; i < 3; ++i) {
        const plant::Counts c = plant::kForce.to_counts(-touch.force[i]);
        counts_[next++] = c.value;
        fits = fits && !c.saturated;
      }
    }
    access_.write(kDaqBase + DaqBoard::kForce, counts_.data(), bytes());
    return fits;
  }

 private:
  std::size_t bytes() const { return counts_.size() * sizeof(std::int32_t); }

  BoardAccess& access_;
  std::vector<std::int32_t> counts_;
};

}  // namespace hvp::vp
