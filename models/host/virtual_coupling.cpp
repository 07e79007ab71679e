#include "models/host/virtual_coupling.h"

namespace hvp::host {

void VirtualCoupling::declare(config::Visitor& v) {
  v.quantity("stiffness", stiffness_N_m, config::Dimension::stiffness,
             {.min = 0, .max = 1e9, .min_open = true},
             {"of the spring between the position that was read and the tool",
              "the most that CHAI3D lets a program ask of a PHANTOM Premium 1.5"});
  v.quantity("damping", damping_N_s_m, config::Dimension::damping, config::between(0, 1e6),
             {"of the damper beside it", "likewise, the largest damping"});
  v.quantity("expected_stiffness", expected_stiffness_N_m, config::Dimension::stiffness,
             config::between(0, 1e9),
             {"by which the host expects a body's force to change while the tool presses it",
              "0: the last force counts; a wall's is known"});
}

Eigen::Vector3d VirtualTool::follow(const Eigen::Vector3d& read,
                                    const Eigen::Vector3d& last_force) {
  if (!place_) return move_to(read, read);
  const Eigen::Vector3d balanced = read - (damper_ * stretch_ + last_force) / both_;
  if (last_force.isZero(0)) return move_to(read, balanced);
  return move_to(read, *place_ + share_ * (balanced - *place_));
}

// Along the wall's normal, with d the tool's depth, d₀ that without a force, and d_b the one
// before: (k_c + b_c/T)·(d₀ − d) = K·d + B·(d − d_b)/T.
Eigen::Vector3d VirtualTool::follow(const Eigen::Vector3d& read, const Wall& wall) {
  if (!place_) place_ = read;
  const Eigen::Vector3d free = read - damper_ / both_ * stretch_;
  const double of_damper = wall.damping_N_s_m / period_s_;
  const double free_depth = wall.depth(free);
  double depth = (both_ * free_depth + of_damper * wall.depth(*place_)) /
                 (both_ + wall.stiffness_N_m + of_damper);
  if (wall.sides == Wall::Sides::one) {
    if (free_depth <= std::max(0.0, depth)) return move_to(read, free);
    // A damped wall's force jumps at its surface, where the tool may have to wait.
    depth = std::max(0.0, depth);
  }
  return move_to(read, free + (free_depth - depth) * wall.direction());
}

Eigen::Vector3d VirtualTool::move_to(const Eigen::Vector3d& read, const Eigen::Vector3d& place) {
  place_ = place;
  stretch_ = read - place;
  largest_ = std::max(largest_, stretch_.norm());
  return place;
}

void VirtualTool::report(config::Figures& f) const {
  f.quantity("largest_stretch_m", largest_, "m",
             "the longest way between the position that was read and the tool");
}

}  // namespace hvp::host
