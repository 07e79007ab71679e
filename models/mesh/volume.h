#pragma once

#include <vector>

#include "models/config/declaration.h"
#include "models/mesh/region.h"
#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

// A part of space as a scenario names it: a sphere, a box, a half space, or what a closed surface
// encloses.
struct Volume {
  enum class Shape { sphere, box, half_space, surface };

  Shape shape = Shape::sphere;
  Region region{.kind = Region::Kind::sphere};  // of any shape but a surface
  config::File surface{};                       // surface
  double surface_unit = 1e-3;                   // m, one unit of the file

  void declare(config::Visitor& v);
  // Throws InputError for a normal of length zero, an empty box or sphere, and shape `surface`
  // without a file.
  void check() const;
};

// The tetrahedra whose centroid is in the volume, its own surface included, ascending. `surface` is
// the closed one with outward normals (surface_check.h) if the shape is `surface`, and not used
// otherwise.
std::vector<int> elements_in(const Volume& volume, const TetMesh& mesh, const Surface& surface);

// How often a closed surface winds round a point: 1 inside, 0 outside, for outward normals. The sum
// of the triangles' solid angles over 4π (van Oosterom, Strackee: The solid angle of a plane
// triangle, IEEE Transactions on Biomedical Engineering, 1983, eq. 8).
double winding_number(const Surface& surface, const Eigen::Vector3d& point);

}  // namespace hvp::mesh
