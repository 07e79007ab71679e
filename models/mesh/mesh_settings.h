#pragma once

#include <Eigen/Core>
#include <string>

#include "models/config/declaration.h"

namespace hvp::mesh {

// How large a body may be, and one unit of its file: from what a haptic device still resolves to
// far beyond what a probe reaches, whose registers count nanometres up to 2 m (models/plant/daq.h).
// No product of four such lengths leaves double precision.
inline constexpr config::Range kBodyLength = config::between(1e-6, 1e3);
inline constexpr config::Range kUnitLength = config::between(1e-9, 1e3);

// The body's shape and how finely it is meshed: the scenario's table [object.mesh].
struct MeshSettings {
  enum class Shape { sphere, box, surface };

  Shape shape = Shape::sphere;
  double radius = 0.05;                                   // m, sphere
  Eigen::Vector3d size = Eigen::Vector3d::Constant(0.1);  // m, box: its three edges
  config::File surface{};                                 // surface
  double surface_unit = 1e-3;                             // m, one unit of the file
  int nodes = 500;

  void declare(config::Visitor& v);
  // Throws InputError: no file for shape `surface`.
  void check() const;
};

}  // namespace hvp::mesh
