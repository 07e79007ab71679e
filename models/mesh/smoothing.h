#pragma once

#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

// Moves inner nodes so that the smallest sine of a dihedral angle around each of them grows
// (Freitag & Ollivier-Gooch, Int. J. Numer. Meth. Engng 40, 1997, with a pattern search in the
// place of their active-set method). Small and large angles are opened alike; neither the
// connections nor the boundary change, and no tetrahedron gets worse than the worst was.
void smooth(TetMesh& mesh);

}  // namespace hvp::mesh
