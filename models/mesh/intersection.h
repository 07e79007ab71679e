#pragma once

#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

// Throws InputError with the key "surface" where triangles of a closed manifold surface cross,
// overlap or touch other than in a common edge or corner. Decided with exact predicates, so
// rounding neither invents nor hides a crossing.
void check_intersections(const Surface& surface);

}  // namespace hvp::mesh
