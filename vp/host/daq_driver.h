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
  // `read_bytes`: DaqBoard::read_bytes(). What is read behind the positions, nobody uses yet.
  DaqDriver(BoardAccess& access, std::size_t probes, std::size_t read_bytes)
      : access_(access), counts_(3 * probes), read_(read_bytes / sizeof(std::int32_t)) {}

  // Latches the tips' positions and reads them, m.
  void read_positions(std::span<collision::Touch> touches) {
    const std::uint32_t latch = 1;
    access_.write(kDaqBase + DaqBoard::kLatch, &latch, sizeof(latch));
    access_.read(kDaqBase + DaqBoard::kPosition, read_.data(), read_.size() * sizeof(std::int32_t));
    std::size_t next = 0;
    for (collision::Touch& touch : touches) {
      for (int i = 0; i < 3; ++i) touch.tip[i] = plant::kPosition.to_value(read_[next++]);
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
    access_.write(kDaqBase + DaqBoard::kForce, counts_.data(),
                  counts_.size() * sizeof(std::int32_t));
    return fits;
  }

 private:
  BoardAccess& access_;
  std::vector<std::int32_t> counts_;
  std::vector<std::int32_t> read_;
};

}  // namespace hvp::vp
