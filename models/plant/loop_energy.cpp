#include "models/plant/loop_energy.h"

#include <algorithm>
#include <array>
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
    const double bound = std::max(kSmallest, kSmallestShare * plant.energy.moved());
    active_ = active_ || -at_port > bound;
  }
  ++frames_;
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
    joules("device_damping", e.device_damping, "of the device's damping");
    joules("hand_damping", e.hand_damping, "of the hand's dampers");
    joules("friction", e.friction, "of dry friction");
    joules("let_go", e.let_go, "what has left with a hand that let go");
  });
  joules("stored_J", e.kinetic + e.springs - e.at_start,
         "kinetic energy and the hand's springs, more than at the start");
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
    joules("least_J", least_, "the least; negative: the loop fed energy in. Flag `active-port`");
    f.frame("frame", least_frame_, "the frame that has it, or null where it never was negative");
  });
}

}  // namespace hvp::plant
