#include "models/plant/kinematics_settings.h"

namespace hvp::plant {

void KinematicsSettings::declare(config::Visitor& v) {
  const auto of_kind =
      v.variant("kind", kind, {{"serial-arm", Kind::serial_arm}, {"five-bar", Kind::five_bar}},
                {.help = "serial-arm: base, shoulder and elbow; five-bar: a planar linkage that "
                         "turns about the line of its motors",
                 .source = "the PHANToM is a serial arm"});
  of_kind.only({Kind::serial_arm}, [&] { v.include(serial_arm); });
  of_kind.only({Kind::five_bar}, [&] { v.include(five_bar); });
  v.vector("home", home, config::Dimension::length, config::between(-2, 2),
           {.help = "where the tip is with all joints at zero, in the coordinates of the body",
            .source = "the body's origin, as in Cavusoglu, Feygin & Tendick 2002"});
}

std::unique_ptr<Kinematics> make_kinematics(const KinematicsSettings& settings) {
  if (settings.kind == KinematicsSettings::Kind::five_bar) {
    return std::make_unique<FiveBar>(settings.five_bar, settings.home);
  }
  return std::make_unique<SerialArm>(settings.serial_arm, settings.home);
}

}  // namespace hvp::plant
