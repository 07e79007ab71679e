#pragma once

#include "models/mesh/tet_mesh.h"

// The one place that calls TetGen (Si, ACM TOMS 41(2), 2015; licence AGPL-3.0).
namespace hvp::mesh {

struct TetgenOptions {
  // The largest admissible volume of a tetrahedron in m³; 0: no limit.
  double max_volume = 0.0;
  // The largest admissible ratio of circumradius to shortest edge; 0: no bound. 1.2 stands for the
  // switches pYq1.2a… with which the figures for the thesis' sphere were obtained.
  double radius_edge_ratio = 1.2;
  // False: TetGen may add points on the surface, whose shape stays what it is.
  bool keep_surface = true;
  int most_added = 0;  // points that TetGen may add; 0: no bound
};

// Fills a closed, consistently oriented surface with tetrahedra. TetGen may crash, hang or exit on
// surfaces it cannot handle, which is why the program meshes in a child process. Throws InputError
// with the key "surface".
TetMesh run_tetgen(const Surface& surface, const TetgenOptions& options);

}  // namespace hvp::mesh
