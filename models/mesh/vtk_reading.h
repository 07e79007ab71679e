#pragma once

#include <string>

#include "models/mesh/file_precheck.h"
#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

// Reads a file with VTK's reader for its format. VTK's readers may crash or print on malformed
// files: call this in a child process (sandbox.h). Throws InputError with the key
// "surface", and VTK's own words where it had some.
Surface read_with_vtk(const std::string& path, SurfaceFormat format, double unit_m);

}  // namespace hvp::mesh
