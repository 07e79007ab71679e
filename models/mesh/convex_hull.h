#pragma once

#include <array>
#include <vector>

#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

// The triangulation of a sphere around the origin whose corners are `points` (at least four,
// not in one plane), which lie on it in order of falling z: their convex hull, triangles
// outward, by insertion one by one. The order makes it cheap: only the triangles near the rim of
// what is there already are looked at.
std::vector<std::array<int, 3>> hull_of_sphere_points(const std::vector<Eigen::Vector3d>& points);

}  // namespace hvp::mesh
