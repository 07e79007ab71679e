#pragma once

#include <optional>

#include "models/mesh/progress.h"
#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

// A closed surface in place of one that is none, and what that changed. Lengths in metres.
struct RepairedSurface {
  Surface surface;  // as check_surface() wants it
  double detail = 0;
  // The largest distance of a new point from the old surface.
  double moved = 0;
  // The share of the old surface's area that is more than two details away from the new one: parts
  // that were inside, and shells that were dropped.
  double left_share = 0;
  double volume = 0;  // m³
  // Of the triangles before, m³, parts that overlap counted twice; absent where they leave holes.
  std::optional<double> old_volume;
  int dropped_shells = 0;
  double dropped_volume = 0;  // m³, cavities that were filled counted as well
};

// Makes the closed surface of one body from triangles that may cross, overlap, leave holes or be
// wound at random in places: the points around which they turn by more than half, by the
// generalised winding number (Jacobson, Kavan, Sorkine-Hornung, SIGGRAPH 2013). A grid gets the
// distance from the triangles, with the sign of that number, and VTK's flying edges the surface
// where it is zero, coarsened to about the old number of points. `detail` is the spacing of the
// grid: nothing much smaller is kept, sharp edges become round by as much, holes are closed by a
// skin; zero: a hundredth of the diagonal. The largest shell stays. Throws InputError with the key
// "surface" where the triangles enclose nothing, for coordinates that are no numbers, and, with the
// key "detail", for a grid of more than kMostGridPoints.
RepairedSurface repair_surface(const Surface& raw, double detail, const Progress& progress = {});

inline constexpr double kMostGridPoints = 20e6;

}  // namespace hvp::mesh
