#include "models/host/wall.h"

#include <algorithm>

#include "models/config/input_error.h"

namespace hvp::host {

void Wall::declare(config::Visitor& v) {
  v.quantity("stiffness", stiffness_N_m, config::Dimension::stiffness, config::between(0, 1e9),
             {"K: of the spring",
              "half of what a device of 0.1 kg and 1 N s/m bears at 500 Hz (docs/stability.md)"});
  v.quantity("damping", damping_N_s_m, config::Dimension::damping, config::between(0, 1e6),
             {"B: of the damper, by the backward difference of the positions that were read",
              "0: the benchmark's undamped wall"});
  v.vector("point", point, config::Dimension::length, config::between(-2, 2),
           {"a point of the plane", "the origin"});
  v.vector("normal", normal, config::Dimension::dimensionless, config::between(-1e3, 1e3),
           {"out of the wall, of any length", "upwards"});
  v.choice("sides", sides, {{"one", Sides::one}, {"both", Sides::both}},
           {"whether it only pushes, as walls do, or holds the tip at its plane by a spring that "
            "pulls too",
            "one: a wall"});
}

void Wall::check() const {
  if (normal.norm() > 0) return;
  throw InputError("normal", "has no length; expected a direction such as [0, 0, 1]");
}

Eigen::Vector3d Wall::force(double depth, double depth_before, double period_s) const {
  if (sides == Sides::one && depth <= 0) return Eigen::Vector3d::Zero();
  double pushes = stiffness_N_m * depth + damping_N_s_m * (depth - depth_before) / period_s;
  if (sides == Sides::one) pushes = std::max(0.0, pushes);
  return pushes * direction();
}

}  // namespace hvp::host
