#pragma once

#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

// Throws InputError with the key "surface" where triangles of a closed manifold surface cross,
// overlap or touch other than in a common edge or corner. Decided with the adaptive exact
// predicates that TetGen carries (Shewchuk, Discrete & Computational Geometry 18, 1997), so
// rounding neither invents nor hides a crossing; triangles in one plane are compared in double
// precision with a margin of 1e-12.
void check_intersections(const Surface& surface);

}  // namespace hvp::mesh
