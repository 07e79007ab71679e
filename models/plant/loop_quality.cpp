#include "models/plant/loop_quality.h"

#include <algorithm>

namespace hvp::plant {

void LoopQuality::add(const LoopSample& s) {
  energy_.add(s.view, s.plant);
  oscillation_.add(s.frame, s.time_s, s.plant.tip.position, s.rests);
  slow_.add(s.frame, s.time_s, s.plant.tip.position, s.rests);
  if (s.drive.dac_saturated || s.drive.current_saturated) ++saturated_;
  if (s.drive.singular || s.read_wrong || s.unreachable) ++at_limit_;
  largest_force_ = std::max(largest_force_, s.plant.motor_force.norm());
  largest_speed_ = std::max(largest_speed_, s.plant.tip.velocity.norm());
  const double current = s.drive.current.cwiseAbs().maxCoeff();
  largest_current_ = std::max(largest_current_, current);
  has_current_ = has_current_ || current > 0;
}

stability::Flags LoopQuality::flags() const {
  stability::Flags flags;
  if (energy_.active()) flags.raise(stability::Flag::active_port);
  if (cycle()) flags.raise(stability::Flag::limit_cycle);
  if (saturated_ > 0) flags.raise(stability::Flag::force_saturated);
  if (at_limit_ > 0) flags.raise(stability::Flag::device_at_its_limit);
  return flags;
}

void LoopQuality::report(config::Figures& f) const {
  f.quantity("largest_force_N", largest_force_, "N", "of the motors, as it was at any latch");
  f.quantity("largest_speed_m_s", largest_speed_, "m/s", "of the tip, likewise");
  f.quantity("largest_current_A", has_current_ ? std::optional(largest_current_) : std::nullopt,
             "A", "of any motor, before its lag; null without `[device.motor]`");
  f.count("saturated_frames", saturated_,
          "whose force converter, amplifier or maker clamped. Any: `force-saturated`");
  f.count("frames_at_limit", at_limit_,
          "out of the joints' reach, at a singular pose, or with a position read wrong. Any: "
          "`device-at-its-limit`");
  f.truth("oscillation_measured", oscillation_.measured(),
          "the intended motion rested long enough to see whether the device comes to rest");
  f.table_or_null("oscillation",
                  "What the device swings on with while its user rests. Flag `limit-cycle`; null "
                  "where it comes to rest.",
                  cycle(), [&f](const Oscillation::Cycle& c) {
                    f.quantity("amplitude_m", c.amplitude_m, "m", "half of peak to peak");
                    f.quantity("frequency_hz", c.frequency_hz, "Hz", "by its turns");
                    f.truth("grows", c.grows, "from one window to the next");
                    f.frame("frame", c.frame, "with which its window ends");
                  });
  f.quantity("moves_on_m_s", oscillation_.moves_on(), "m/s",
             "how fast the device moved on in the last quarter of a second, its user at rest: it "
             "flies or drifts away, or swings slower than 6 Hz; null where it does not");
  f.table("energy", "Where energy came from and went ([plant.md](plant.md)).", energy_);
}

}  // namespace hvp::plant
