#include "app/results/mesh_file.h"

#include <stdexcept>

#include <fmt/format.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkUnstructuredGrid.h>

#include "app/results/grid_file.h"

namespace hvp::results {

void write_mesh(const std::filesystem::path& path, const mesh::TetMesh& mesh,
                const ElementQuality& quality) {
  const std::size_t elements = mesh.tetrahedra.size();
  if (quality.min_dihedral_angle_deg.size() != elements || quality.aspect_ratio.size() != elements)
    throw std::invalid_argument(
        fmt::format("{} dihedral angles and {} aspect ratios for {} tetrahedra",
                    quality.min_dihedral_angle_deg.size(), quality.aspect_ratio.size(), elements));
  const auto grid = grid_of(mesh);
  grid->GetCellData()->AddArray(
      double_array("min_dihedral_angle_deg", 1, quality.min_dihedral_angle_deg));
  grid->GetCellData()->AddArray(double_array("aspect_ratio", 1, quality.aspect_ratio));
  write_grid(path, *grid);
}

}  // namespace hvp::results
