#include "models/plant/encoder.h"

#include <cmath>

namespace hvp::plant {

void Encoder::declare(config::Visitor& v) {
  v.quantity("resolution", resolution, config::Dimension::length, config::between(1e-9, 10e-3),
             {.help = "step of the position that is read, along each axis",
              .source = "Phantom Omni, nominal position resolution 0.055 mm (data sheet); Premium "
                        "1.5: 0.03 mm"});
}

Eigen::Vector3d Encoder::read(const Eigen::Vector3d& position) const {
  Eigen::Vector3d read;
  for (int i = 0; i < 3; ++i) read[i] = std::round(position[i] / resolution) * resolution;
  return read;
}

}  // namespace hvp::plant
