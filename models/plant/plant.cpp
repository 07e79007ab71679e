#include "models/plant/plant.h"

namespace hvp::plant {

void DeviceDynamics::declare(config::Visitor& v) {
  v.quantity("mass", mass_kg, config::Dimension::mass, {.min = 1e-4, .max = 1e3},
             {"apparent mass at the tip",
              "data sheets: a PHANTOM Premium 1.5 has less than 75 g, an Omni 45 g"});
  v.vector("mass_factor", mass_factor, config::Dimension::dimensionless, config::between(1e-3, 1e3),
           {"of the apparent mass along x, y and z", "the same along each axis"});
  v.quantity("damping", damping_N_s_m, config::Dimension::damping, config::between(0, 1e4),
             {"viscous damping of the device",
              "assumed; CHAI3D lets a Premium 1.5 be damped with 5 N s/m"});
}

void Gravity::declare(config::Visitor& v) {
  v.vector("acceleration", acceleration, config::Dimension::acceleration,
           config::between(-1e3, 1e3),
           {"of gravity; a tilted device has it along other axes", "standard gravity, downwards"});
  v.quantity("compensated", compensated, config::Dimension::dimensionless, config::between(0, 1),
             {"share of the weight that counterweights or springs of the device carry",
              "absent: a desktop device's links are heavy in the hand"});
}

LinearAxis Plant::axis(int i) const {
  LinearAxis axis;
  axis.mass = dynamics.mass_kg * dynamics.mass_factor[i];
  axis.damping = dynamics.damping_N_s_m;
  axis.lag_rate = force_lag_rate;
  if (hand) hand->hold(axis);
  return axis;
}

Eigen::Vector3d Plant::weight() const {
  if (!gravity) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d masses = dynamics.mass_kg * dynamics.mass_factor;
  return (1 - gravity->compensated) * masses.cwiseProduct(gravity->acceleration);
}

}  // namespace hvp::plant
