#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

// A tetrahedron is a sliver if one of its dihedral angles is below or above these (degrees). Thesis
// §3.3 warns of angles near 0° and 180°; 5° and 175° are the customary bounds.
inline constexpr double kSliverLowAngle = 5.0;
inline constexpr double kSliverHighAngle = 175.0;

// The number of bins of the histogram of dihedral angles: ten degrees each, [0, 10) to [170, 180].
inline constexpr std::size_t kDihedralBins = 18;

struct Quality {
  std::size_t nodes = 0;
  std::size_t tetrahedra = 0;
  std::size_t boundary_triangles = 0;
  double volume = 0.0;            // m³
  double min_det_jacobian = 0.0;  // m³; six times the smallest signed volume
  std::size_t inverted = 0;       // tetrahedra with det J ≤ 0
  double min_dihedral = 0.0;      // degrees
  double max_dihedral = 0.0;      // degrees
  // Longest edge over shortest edge; thesis §3.3 asks for at most 2 to 4.
  double max_aspect_ratio = 0.0;
  // Circumradius over three times the inradius: 1 for the regular tetrahedron.
  double max_radius_ratio = 0.0;
  std::size_t slivers = 0;  // tetrahedra with an angle beyond the two bounds above
  // The non-zeros of a row of the stiffness matrix: three times (neighbours + 1) of its node.
  double mean_row_nonzeros = 0.0;
  std::size_t max_row_nonzeros = 0;
  std::array<std::size_t, kDihedralBins> dihedral_histogram{};
};

Quality measure(const TetMesh& mesh);

// Figures of each tetrahedron, one value for each.
struct ElementShapes {
  std::vector<double> min_dihedral;  // degrees
  std::vector<double> aspect_ratio;  // longest edge over shortest edge
};
ElementShapes element_shapes(const TetMesh& mesh);

// The histogram as text, one line a bin with a bar at most `width` characters long.
std::string draw_dihedral_histogram(const Quality& quality, std::size_t width = 40);

}  // namespace hvp::mesh
