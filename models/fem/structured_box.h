#pragma once

#include <Eigen/Core>
#include <array>

#include "models/mesh/tet_mesh.h"

namespace hvp::fem {

// The division of a cell into six tetrahedra. `same`: every cell is cut along the same diagonal
// (Kuhn's subdivision). `mirrored`: each cell mirrors its neighbours, so that the mesh has the
// symmetry planes of the box between any two cells.
enum class CellCut { same, mirrored };

// A box [0, size] of cells[0] × cells[1] × cells[2] equal cells, six tetrahedra each. Convergence
// is measured on this mesh. Node (i, j, k) has the number i + (cells[0] + 1)·(j + (cells[1] +
// 1)·k). Tetrahedra have det J > 0, the boundary points outwards.
mesh::TetMesh structured_box(const Eigen::Vector3d& size, const std::array<int, 3>& cells,
                             CellCut cut = CellCut::same);

}  // namespace hvp::fem
