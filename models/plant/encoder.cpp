#include "models/plant/encoder.h"

#include <cmath>

namespace hvp::plant {

void Encoder::declare(config::Visitor& v) {
  const auto where = v.variant("at", at, {{"tip", At::tip}, {"joints", At::joints}},
                               {.help = "where the steps are equal: at the tip, or at the joints "
                                        "of [device.kinematics]",
                                .source = "tip: what data sheets state"});
  where.only({At::tip}, [&] {
    v.quantity("resolution", resolution, config::Dimension::length, config::between(1e-9, 10e-3),
               {.help = "step of the position that is read, along each axis",
                .source = "Phantom Omni, nominal position resolution 0.055 mm (data sheet); "
                          "Premium 1.5: 0.03 mm"});
  });
  where.only({At::joints}, [&] { v.include(joints); });
}

Encoder::Reading Encoder::read(const Eigen::Vector3d& position,
                               const Kinematics* kinematics) const {
  Reading reading{position, false};
  if (at == At::tip) {
    for (int i = 0; i < 3; ++i) {
      reading.position[i] = std::round(position[i] / resolution) * resolution;
    }
    return reading;
  }
  const auto read = joints.read(*kinematics, position, reading.wrong);
  if (read) {
    reading.position = *read;
  } else {
    reading.wrong = true;
  }
  return reading;
}

}  // namespace hvp::plant
