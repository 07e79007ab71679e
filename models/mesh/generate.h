#pragma once

#include "models/mesh/mesh_settings.h"
#include "models/mesh/progress.h"
#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

// The body that the settings describe, meshed to within 10 % of the wanted node count. The
// parametric sphere and box are centred on the origin; a surface file keeps its coordinates.
// Equal settings give equal bits.
//
// TetGen may crash, hang or exit on a surface of a user, and VTK's readers on a file: who takes
// either from a user calls this in a child process. Throws InputError with the key "nodes" if the
// count cannot be reached and "surface" if the file or its surface is at fault; the message says
// what was found.
TetMesh generate(const MeshSettings& settings, const Progress& progress = {});

// The same for a given surface, in either winding. The surface is kept if the count can be reached
// with it; otherwise its triangles are split or decimated. `quadratic`: of ten-node tetrahedra.
TetMesh tetrahedralise(const Surface& raw, int wanted_nodes, const Progress& progress = {},
                       bool quadratic = false);

}  // namespace hvp::mesh
