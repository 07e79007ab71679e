#pragma once

#include <array>
#include <functional>
#include <string>

#include "models/mesh/tet_mesh.h"

// Small surfaces and what the tests count on them.
namespace hvp::mesh::testing {

// A cube of edge 1 m from the origin, 8 points and 12 triangles, outward.
Surface unit_cube();
// The same, moved.
Surface moved(Surface surface, const Eigen::Vector3d& by);
// The other winding.
Surface turned_inside_out(Surface surface);
// Both surfaces in one.
Surface together(const Surface& a, const Surface& b);

// points − edges + triangles: 2 for the surface of one body without handles.
int euler_characteristic(const std::vector<std::array<int, 3>>& triangles);

// ∮ x·n dA / 3, the volume by the divergence theorem; right only with outward normals.
double volume_from_boundary(const TetMesh& mesh);

// The message of the InputError that `action` throws; fails where it throws none or where its
// key is another.
std::string refusal(const std::string& key, const std::function<void()>& action);

}  // namespace hvp::mesh::testing
