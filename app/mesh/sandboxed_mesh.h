#pragma once

#include <string>

#include "app/process/progress.h"
#include "models/mesh/mesh_settings.h"
#include "models/mesh/surface_repair.h"
#include "models/mesh/tet_mesh.h"

// The mesher and the readers of surfaces in child processes with limits on time and memory: TetGen
// and VTK may crash, hang, exit and print on a user's surface, and the program has to refuse it in
// one line. Call these before threads or a SystemC kernel exist, since they fork.
namespace hvp::app {

// mesh::generate(). A file that breaks a reader and a surface that breaks TetGen end in an
// InputError with the key "surface".
mesh::TetMesh sandboxed_mesh(const mesh::MeshSettings& settings, const Progress& progress = {});

// mesh::read_surface(), with the same ending.
mesh::Surface sandboxed_surface(const std::string& path, double unit_m);

// mesh::repair_surface() of a file, with the same ending. The surface is one that a file of single
// precision in this unit has too.
mesh::RepairedSurface sandboxed_repair(const std::string& path, double unit_m, double detail_m,
                                       const Progress& progress);

}  // namespace hvp::app
