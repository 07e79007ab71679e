#pragma once

#include <Eigen/Core>
#include <string>

#include "models/config/declaration.h"

namespace hvp::mesh {

// The range of a body's length, and of one unit of its file: from the resolution of a haptic device
// to far beyond the reach of a probe, whose registers count nanometres up to 2 m
// (models/plant/daq.h).
// No product of four such lengths leaves double precision.
inline constexpr config::Range kBodyLength = config::between(1e-6, 1e3);
inline constexpr config::Range kUnitLength = config::between(1e-9, 1e3);

// The body's shape and the resolution of its mesh: the scenario's table [object.mesh].
struct MeshSettings {
  enum class Shape { sphere, box, surface };

  Shape shape = Shape::sphere;
  double radius = 0.05;                                   // m, sphere
  Eigen::Vector3d size = Eigen::Vector3d::Constant(0.1);  // m, box: its three edges
  config::File surface{};                                 // surface
  double surface_unit = 1e-3;                             // m, one unit of the file
  int nodes = 500;         // of ten-node tetrahedra the mid-edge nodes are among them
  bool quadratic = false;  // ten-node tetrahedra; set by whoever declares the elements

  void declare(config::Visitor& v);
  // Throws InputError if shape `surface` has no file.
  void check() const;
};

}  // namespace hvp::mesh
