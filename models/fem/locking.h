#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "models/fem/materials.h"
#include "models/fem/quadratic_element.h"
#include "models/mesh/tet_mesh.h"

namespace hvp::fem {

// Linear tetrahedra are too stiff in bending, and the more so the closer ν comes to one half:
// they lock. Above this ratio a run reports it with a figure.
inline constexpr double kLockingPoissonRatio = 0.45;

// The tip deflection of a cantilever of square section and length five, divided by Timoshenko's
// (PL³/3EI + PL/κGA with κ = 10(1 + ν)/(12 + 11ν)), for a mesh of `cells` cubic cells a side of
// the section: 1 is exact, 0.3 means more than three times too stiff. Solved when called, on a
// quarter of the beam: the section's two middle planes are planes of symmetry and antisymmetry.
// `cells` is even, 2 to most_locking_cells(); otherwise InputError.
double cantilever_ratio(double poisson_ratio, int cells, Elements elements = Elements::linear);
// Ten of linear tetrahedra, six of quadratic ones, which have as many nodes.
constexpr int most_locking_cells(Elements elements) {
  return elements == Elements::linear ? 10 : 6;
}

// The number of cubic cells, of six tetrahedra of the mesh's mean volume each, that fit across the
// body's bounding box in its thinnest direction; or those of a part, of these elements.
double cells_across(const mesh::TetMesh& mesh);
double cells_across(const mesh::TetMesh& mesh, std::span<const int> elements);

struct Locking {
  std::size_t material = 0;    // of the part, an index into the materials
  int cells = 0;               // cells of the solved cantilever
  double stiffness_ratio = 0;  // cantilever_ratio at these cells and the material's ν
  std::string sentence;        // the line for the terminal
};

// The locking if ν > 0.45, otherwise nothing, and nothing of elements with mean dilatation; of
// several materials, that of the part that locks most. The cantilever has the resolution of the
// part's mesh, rounded to an even number of cells and limited to 2 … most_locking_cells(). It
// stands for bending at this resolution: a body of linear elements that is only compressed locks
// less, quadratic ones hardly lock in bending, and more where a thin body is pressed.
std::optional<Locking> measure_locking(const mesh::TetMesh& mesh, const Materials& materials,
                                       Elements elements = Elements::linear);

}  // namespace hvp::fem
