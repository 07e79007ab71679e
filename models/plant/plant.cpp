#include "models/plant/plant.h"

#include <numbers>
#include <string_view>

#include "fmt/format.h"
#include "models/config/input_error.h"

namespace hvp::plant {

void Friction::declare(config::Visitor& v) {
  v.quantity("force", force_N, config::Dimension::force, config::between(0, 100),
             {"dry friction against a device that slips, along each axis",
              "Phantom Omni, backdrive friction 0.26 N (data sheet); Premium 1.5: 0.04 N"});
  v.quantity("static_force", static_force_N, config::Dimension::force, config::between(0, 100),
             {"what holds a device that stands; 0: as much as force", "no data sheet states it"});
}

void Friction::check() const {
  if (hold() >= force_N) return;
  throw InputError("static_force",
                   fmt::format("{:g} N; expected 0, or at least force, which is {:g} N",
                               static_force_N, force_N));
}

void Structure::declare(config::Visitor& v) {
  constexpr std::string_view kAssumed =
      "assumed: real devices have tens to hundreds of Hz, hardly damped (Diaz & Gil 2010; "
      "Cavusoglu, Feygin & Tendick 2002)";
  v.quantity("frequency", frequency_Hz, config::Dimension::frequency, config::between(1, 1e4),
             {"of the mode of the device in nobody's hand, with its motors free", kAssumed});
  v.quantity("damping_ratio", damping_ratio, config::Dimension::dimensionless,
             config::between(0, 1), {"of that mode, of the critical damping", kAssumed});
  v.quantity(
      "handle_share", handle_share, config::Dimension::dimensionless, config::between(0.01, 0.99),
      {"of the apparent mass that is beyond the structure, with the handle", "assumed: half"});
}

void Structure::divide(LinearAxis& axis) const {
  const double whole = axis.mass;
  axis.handle_mass = handle_share * whole;
  axis.mass = whole - axis.handle_mass;
  const double reduced = axis.mass * axis.handle_mass / whole;
  const double omega = 2 * std::numbers::pi * frequency_Hz;
  axis.structure_stiffness = reduced * omega * omega;
  axis.structure_damping = 2 * damping_ratio * reduced * omega;
}

namespace {
using config::Dimension;
constexpr double kLightest = 1e-3;  // kg, on a grip
constexpr const char* kSpeich =
    "Speich, Shao & Goldfarb 2005 (Mechatronics 15): five parameters of an arm";
}  // namespace

Hand Hand::of(Model model) {
  if (model != Model::arm) return {.model = model};
  return {.mass_kg = 1.5,
          .stiffness_N_m = 49,
          .damping_N_s_m = 7.9,
          .grip_stiffness_N_m = 375,
          .grip_damping_N_s_m = 4.5,
          .model = model};
}

void Hand::declare(config::Visitor& v) {
  const auto of_model = v.variant(
      "model", model,
      {{"spring-damper", Model::spring_damper}, {"arm", Model::arm}, {"custom", Model::custom}},
      {"spring-damper: 375 N/m and 4.5 N s/m, no mass; arm: 1.5 kg on "
       "49 N/m and 7.9 N s/m, gripping with 375 N/m and 4.5 N s/m; "
       "custom: the keys below",
       kSpeich});
  of_model.only({Model::custom}, [&] {
    v.quantity("mass", mass_kg, Dimension::mass, config::between(0, 1e3),
               {"of the hand", "0: of a fingertip grip, small"});
    v.quantity("stiffness", stiffness_N_m, Dimension::stiffness, config::between(0, 1e6),
               {"of the spring between the intended motion and the hand", kSpeich});
    v.quantity("damping", damping_N_s_m, Dimension::damping, config::between(0, 1e4),
               {"of the damper beside it", kSpeich});
    v.quantity("grip_stiffness", grip_stiffness_N_m, Dimension::stiffness, config::between(0, 1e6),
               {"of the spring between the hand and the device; 0: rigid", "the simpler model"});
    v.quantity("grip_damping", grip_damping_N_s_m, Dimension::damping, config::between(0, 1e4),
               {"of the damper beside it", "the simpler model"});
  });
  v.quantity("lets_go", lets_go_s, Dimension::time, config::between(0, 1e6),
             {"when the hand lets go of the device, which keeps its velocity; 0: never",
              "most users do not"});
  if (model == Model::custom) return;
  const double when = lets_go_s;
  *this = of(model);
  lets_go_s = when;
}

void Hand::check() const {
  if (grip_stiffness_N_m > 0 && mass_kg < kLightest) {
    throw InputError("mass", fmt::format("{:g} kg; a hand on a grip that is not rigid expects at "
                                         "least {:g} kg, or grip_stiffness 0",
                                         mass_kg, kLightest));
  }
  if (grip_stiffness_N_m == 0 && grip_damping_N_s_m > 0) {
    throw InputError("grip_damping",
                     fmt::format("{:g} N s/m in a rigid grip; expected 0, or a grip_stiffness",
                                 grip_damping_N_s_m));
  }
}

void Hand::hold(LinearAxis& axis) const {
  axis.hand_mass = mass_kg;
  axis.hand_stiffness = stiffness_N_m;
  axis.hand_damping = damping_N_s_m;
  axis.grip_stiffness = grip_stiffness_N_m;
  axis.grip_damping = grip_damping_N_s_m;
}

void DeviceDynamics::declare(config::Visitor& v) {
  const auto where =
      v.variant("at", at, {{"tip", At::tip}, {"joints", At::joints}},
                {"where the inertia is always the same: at the tip, or at the joints of "
                 "[device.kinematics], and then the apparent mass follows the pose",
                 "tip: what data sheets state"});
  where.only({At::tip}, [&] {
    v.quantity("mass", mass_kg, config::Dimension::mass, {.min = 1e-4, .max = 1e3},
               {"apparent mass at the tip",
                "data sheets: a PHANTOM Premium 1.5 has less than 75 g, an Omni 45 g"});
    v.vector("mass_factor", mass_factor, config::Dimension::dimensionless,
             config::between(1e-3, 1e3),
             {"of the apparent mass along x, y and z", "the same along each axis"});
  });
  where.only({At::joints}, [&] { v.include(joints); });
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

std::unique_ptr<Kinematics> Plant::pose_of_mass() const {
  if (dynamics.at == DeviceDynamics::At::tip) return nullptr;
  return make_kinematics(kinematics.value());
}

Eigen::Vector3d Plant::masses() const {
  const std::unique_ptr<Kinematics> pose = pose_of_mass();
  if (!pose) return dynamics.mass_kg * dynamics.mass_factor;
  const auto masses = dynamics.joints.apparent_mass(*pose, intended.start);
  if (masses) return *masses;
  throw InputError("start",
                   "has no apparent mass: expected a place that the device reaches with "
                   "no joints in line");
}

LinearAxis Plant::axis(int i) const {
  LinearAxis axis;
  axis.mass = masses()[i];
  axis.damping = dynamics.damping_N_s_m;
  axis.lag_rate = force_lag_rate;
  if (structure) structure->divide(axis);
  if (hand) hand->hold(axis);
  return axis;
}

Eigen::Vector3d Plant::weight() const {
  if (!gravity) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d heavy = dynamics.at == DeviceDynamics::At::joints
                                    ? Eigen::Vector3d::Constant(dynamics.joints.tip_mass_kg)
                                    : masses();
  return (1 - gravity->compensated) * heavy.cwiseProduct(gravity->acceleration);
}

}  // namespace hvp::plant
