#pragma once

#include <filesystem>
#include <vector>

#include "models/mesh/tet_mesh.h"

// A run directory made from formulas, for what reads results: no solver, no platform.
namespace hvp::sample {

// A ball of the given radius (m) around the origin: a cube of cells³ cells, six tetrahedra each,
// drawn radially onto the ball. Volumes are positive; the boundary points outwards.
mesh::TetMesh ball(double radius_m, int cells);

// The nodes of the lowest part of the mesh, by z, in ascending order.
std::vector<int> lowest_nodes(const mesh::TetMesh& mesh, double fraction);

struct RunShape {
  int frames = 200;
  int step_every = 50;  // frames between two deformation steps
  int cells = 6;
  bool lump = false;  // a region round the centre
};

// A ball whose top is pressed in and let go again, in `directory`, which exists: the deformation
// steps, frames.csv and summary.json. The frame of the largest force is the middle one.
void write_run(const std::filesystem::path& directory, const RunShape& shape);

}  // namespace hvp::sample
