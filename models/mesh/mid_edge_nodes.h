#pragma once

#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

// The same body of ten-node tetrahedra: a node in the middle of each edge of the four-node ones,
// and of each boundary triangle four. The given nodes keep their numbers; those of the edges follow
// in the order of their ends, the lower one first. The board deals its rows by length
// (accel::deal_rows), so that no numbering balances its partitions better than another.
TetMesh with_mid_edge_nodes(TetMesh mesh);

}  // namespace hvp::mesh
