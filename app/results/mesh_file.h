#pragma once

#include <filesystem>
#include <span>

#include "models/mesh/tet_mesh.h"

namespace hvp::results {

// One value for every tetrahedron.
struct ElementQuality {
  std::span<const double> min_dihedral_angle_deg;
  std::span<const double> aspect_ratio;  // longest edge over shortest edge
};

// The mesh with the cell arrays `min_dihedral_angle_deg` and `aspect_ratio` as a .vtu file that
// ParaView opens. Throws std::invalid_argument when a span does not have one value a
// tetrahedron, std::runtime_error when the file cannot be written.
void write_mesh(const std::filesystem::path& path, const mesh::TetMesh& mesh,
                const ElementQuality& quality);

}  // namespace hvp::results
