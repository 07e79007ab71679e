#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "models/config/figures.h"
#include "models/plant/loop_energy.h"
#include "models/plant/oscillation.h"
#include "models/plant/output_stage.h"
#include "models/stability/flag.h"

namespace hvp::plant {

// A device in one frame.
struct LoopSample {
  std::int64_t frame = 0;
  double time_s = 0;  // of its latch
  HostView view;
  PlantState plant;
  Drive drive;
  bool read_wrong = false;   // the position read is another one than the tip's
  bool rests = false;        // the intended motion does, or nobody holds the device
  bool unreachable = false;  // the joints have no regular pose for the tip
};

// What a run's closed loop is like, of one device with mass.
class LoopQuality {
 public:
  // Frames in their order.
  void add(const LoopSample& sample);

  const LoopEnergy& energy() const { return energy_; }
  const Oscillation& oscillation() const { return oscillation_; }
  // What the device swings on with: quick, or where nothing is, slow.
  const std::optional<Oscillation::Cycle>& cycle() const {
    return oscillation_.cycle() ? oscillation_.cycle() : slow_.cycle();
  }
  std::int64_t saturated_frames() const { return saturated_; }
  std::int64_t limit_frames() const { return at_limit_; }

  // active-port, limit-cycle, force-saturated, device-at-its-limit.
  stability::Flags flags() const;
  void report(config::Figures& f) const;

 private:
  static constexpr double kSlowWindowSeconds = 1.5;  // swings from 1 Hz on

  LoopEnergy energy_;
  Oscillation oscillation_;
  Oscillation slow_{kSlowWindowSeconds};
  std::int64_t saturated_ = 0;
  std::int64_t at_limit_ = 0;
  double largest_force_ = 0;    // of the motors, at latches, N
  double largest_speed_ = 0;    // m/s
  double largest_current_ = 0;  // A
  bool has_current_ = false;
};

}  // namespace hvp::plant
