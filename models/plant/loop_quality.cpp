#include "models/plant/loop_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace hvp::plant {

namespace {
constexpr double kSmallest = 1e-6;       // J
constexpr double kSmallestShare = 1e-3;  // of the energy moved
}  // namespace

void LoopEnergy::add(const HostView& view, const PlantState& plant) {
  if (any_) {
    const Eigen::Vector3d mean = 0.5 * (view_.force + view.force);
    body_ += mean.dot(view.read - view_.read);
    true_ += mean.dot(plant.tip.position - last_.tip.position);
  }
  if (!any_) at_start_ = view.stored;
  any_ = true;
  view_ = view;
  last_ = plant;
  const double at_port = at_start_ + plant.energy.at_port();
  if (at_port < least_) {
    least_ = at_port;
    least_frame_ = frames_;
    active_ = active_ || fed_in(at_port, plant.energy);
  }
  ++frames_;
}

bool LoopEnergy::fed_in(double at_port, const Energy& energy) {
  return -at_port > std::max(kSmallest, kSmallestShare * energy.moved());
}

void LoopEnergy::report(config::Figures& f) const {
  const Energy& e = last_.energy;
  const auto joules = [&f](std::string_view key, double value, std::string_view help) {
    f.quantity(key, value, "J", help);
  };
  f.table("in_J", "Work on device and hand; negative: taken from them.", [&] {
    joules("motors", e.by_motors, "of the motors' real force");
    joules("hand", e.by_intention, "of the hand's intention, through its spring and damper");
    joules("gravity", e.by_gravity, "of the weight");
  });
  f.table("lost_J", "What is heat.", [&] {
    joules("device_damping", e.device_damping, "of the device's damping, its structure's too");
    joules("hand_damping", e.hand_damping, "of the hand's dampers");
    joules("friction", e.friction, "of dry friction");
    joules("let_go", e.let_go, "what has left with a hand that let go");
  });
  joules("stored_J", e.kinetic + e.springs - e.at_start,
         "kinetic energy and the springs of structure and hand, more than at the start");
  f.ratio("imbalance_rel", e.moved() > 0 ? e.imbalance() / e.moved() : 0,
          "what is stored, less all works, plus all losses, of the energy moved: rounding");
  f.table("of_motors_J", "Whose doing the motors' work is; positive: that part fed energy in.",
          [&] {
            joules("body", body(), "of the body or wall, as the host saw it");
            joules("encoder", encoder(), "since positions are read in steps");
            joules("latency", latency(), "since forces are late, and held for a period");
            joules("converter", converter(), "of converter steps and current limits");
            joules("amplifier", amplifier(), "since currents lag behind");
          });
  const std::array<std::pair<std::string_view, double>, 5> parts = {{{"body", body()},
                                                                     {"encoder", encoder()},
                                                                     {"latency", latency()},
                                                                     {"converter", converter()},
                                                                     {"amplifier", amplifier()}}};
  std::vector<std::string> feeds;
  for (const auto& [name, value] : parts) {
    if (value > kSmallestShare * e.moved()) feeds.emplace_back(name);
  }
  f.value("fed_by", feeds, {},
          "parts of `of_motors_J` that fed in more than a thousandth of the energy moved");
  f.table("port", "The passivity observer: what all but masses and hand have absorbed.", [&] {
    joules("least_J", least_,
           "the least. Negative by more than 1 uJ and a thousandth of the energy moved: the "
           "loop fed energy in, flag `active-port`");
    f.frame("frame", least_frame_, "the frame that has it, or null where it never was negative");
  });
}

void LoopQuality::add(const LoopSample& s) {
  energy_.add(s.view, s.plant);
  rest_.add(s.frame, s.time_s, s.plant.tip.position, s.rests);
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
  if (rest_.cycle()) flags.raise(stability::Flag::limit_cycle);
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
  f.truth("oscillation_measured", rest_.verdict() != RestWatch::Verdict::not_measured,
          "the user rested long enough to see whether the device comes to rest");
  f.table_or_null("oscillation",
                  "What the device swings on with while its user rests. Flag `limit-cycle`; null "
                  "where no swing lasts.",
                  rest_.cycle(), [&f](const Oscillation::Cycle& c) {
                    f.quantity("amplitude_m", c.amplitude_m, "m", "half of peak to peak");
                    f.quantity("frequency_hz", c.frequency_hz, "Hz", "by its turns");
                    f.truth("grows", c.grows, "from one window to the next");
                    f.frame("frame", c.frame, "with which its window ends");
                  });
  f.quantity("moves_on_m_s", rest_.moves_on(), "m/s",
             "how fast the device moved on in the last window of its user's rest: it flies or "
             "drifts away, or swings slower than the run can tell; null where it does not");
  f.quantity(
      "last_moves_m", rest_.last_moves_m(), "m",
      "peak to peak in the last quarter to half of a second of its user's rest, of the worst "
      "rest; null without one");
  f.table("energy", "Where energy came from and went ([plant.md](plant.md)).", energy_);
}

}  // namespace hvp::plant
