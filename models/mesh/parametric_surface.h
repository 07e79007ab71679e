#pragma once

#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

// A sphere around the origin with `points` points (at least 4) on it, spaced almost evenly: the
// convex hull of a Fibonacci lattice. Any number of points is possible, which a subdivided
// icosahedron does not offer. Computed in double with +, ·, / and √ only, so that the bits do
// not depend on a mathematics library. Outward normals.
Surface sphere_surface(double radius, int points);

// A box centred on the origin with edges `size`, every face a grid of right triangles with
// edges of about `edge_length`; one cell a side at least. Outward normals.
Surface box_surface(const Eigen::Vector3d& size, double edge_length);

}  // namespace hvp::mesh
