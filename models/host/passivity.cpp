#include "models/host/passivity.h"

#include <algorithm>

namespace hvp::host {

void Passivity::declare(config::Visitor& v) {
  v.quantity("largest_damping", largest_damping_N_s_m, config::Dimension::damping,
             {.min = 0, .max = 1e6, .min_open = true},
             {"that the controller may add; it is held for a period like every force",
              "assumed: a mass of 0.1 kg bears 50 N s/m for 2 ms (m/T)"});
  v.quantity("largest_force", largest_force_N, config::Dimension::force,
             {.min = 0, .max = 1e6, .min_open = true},
             {"of that damping", "PHANTOM Premium 1.5: CHAI3D, src/devices/CPhantomDevices.cpp"});
}

Eigen::Vector3d PassivityController::damping(const Eigen::Vector3d& read,
                                             const Eigen::Vector3d& force) {
  const Eigen::Vector3d way = read_ ? Eigen::Vector3d(read - *read_) : Eigen::Vector3d::Zero();
  read_ = read;
  energy_ += sent_.dot(way);
  least_ = std::min(least_, energy_);
  Eigen::Vector3d added = Eigen::Vector3d::Zero();
  const double squared = way.squaredNorm();
  acts_ = energy_ < 0 && squared > 0;
  if (acts_) {
    const double wanted = -energy_ * period_s_ / squared;
    const double allowed = std::min(settings_.largest_damping_N_s_m,
                                    settings_.largest_force_N * period_s_ / way.norm());
    const double alpha = std::min(wanted, allowed);
    added = (alpha / period_s_) * way;
    largest_ = std::max(largest_, alpha);
    ++acted_;
    if (wanted > allowed) ++bound_;
  }
  sent_ = force + added;
  return added;
}

void PassivityController::report(config::Figures& f) const {
  f.quantity("observed_J", energy_, "J",
             "what body or wall had absorbed in the end, as the host counts it: the force that it "
             "sent, times the way until the next position that it read");
  f.quantity("least_J", least_, "J", "the least of that in any frame: what was ever owed");
  f.count("frames_acted", acted_, "in which the controller damped");
  f.count("frames_bound", bound_,
          "of those, in which `largest_damping` or `largest_force` left a debt for the next frame");
  f.quantity("largest_damping_N_s_m", largest_, "N·s/m", "α of the frame with the most");
}

}  // namespace hvp::host
