#pragma once

#include <functional>

#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

// A mesh of ten-node tetrahedra with `wanted` nodes in all, within kAcceptedDeviation, so that a
// board of 500 nodes stays one. `mesh_with` makes meshes of four-node tetrahedra with a number of
// corners, which is searched: each corner brings five or six edges. Throws InputError with the key
// "nodes" where the count cannot be reached; the message offers the nearest one for which a mesh
// was then made in the same way.
TetMesh mesh_with_mid_edge_nodes(const std::function<TetMesh(int corners)>& mesh_with, int wanted);

}  // namespace hvp::mesh
