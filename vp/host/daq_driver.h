#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "models/plant/daq.h"
#include "vp/device/daq_board.h"
#include "vp/host/board_access.h"

namespace hvp::vp {

// The servo process' accesses to the data acquisition board.
class DaqDriver {
 public:
  explicit DaqDriver(BoardAccess& access) : access_(access) {}

  // Latches the tip's position and reads it, m.
  Eigen::Vector3d read_position() {
    const std::uint32_t latch = 1;
    access_.write(kDaqBase + DaqBoard::kLatch, &latch, sizeof(latch));
    std::array<std::int32_t, 3> counts{};
    access_.read(kDaqBase + DaqBoard::kPosition, counts.data(), sizeof(counts));
    return {plant::kPosition.to_value(counts[0]), plant::kPosition.to_value(counts[1]),
            plant::kPosition.to_value(counts[2])};
  }

  // What the device is to exert, N. False where the register had no room for it.
  bool write_force(const Eigen::Vector3d& force) {
    std::array<std::int32_t, 3> counts{};
    bool fits = true;
    for (int i = 0; i < 3; ++i) {
      const plant::Counts c = plant::kForce.to_counts(force[i]);
      counts[static_cast<std::size_t>(i)] = c.value;
      fits = fits && !c.saturated;
    }
    access_.write(kDaqBase + DaqBoard::kForce, counts.data(), sizeof(counts));
    return fits;
  }

 private:
  BoardAccess& access_;
};

}  // namespace hvp::vp
