#pragma once

#include <string>

#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

// Reads a surface file, STL (text or binary), PLY, OBJ, VTP or VTU by its extension. One unit of
// the file is `unit_m` metres. Polygons are split into triangles, points that coincide exactly
// are merged, unused points dropped. A VTU's surface is the outer surface of its volume cells.
// The triangles keep the file's winding; of the surface only its place and its width are checked
// here (see surface_check.h): within kBodyLength, and not so far from the origin that nothing is
// left of the digits of its coordinates.
//
// The reader runs in a child process with limits on time and memory, so that a file that breaks
// it ends here as an InputError with the key "surface" and what was found.
Surface read_surface(const std::string& path, double unit_m);

}  // namespace hvp::mesh
