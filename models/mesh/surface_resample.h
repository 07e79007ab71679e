#pragma once

#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

// Halves every edge longer than `longest_edge` (m), the longest first, until none is left. The
// shape stays what it was; long and flat triangles become shorter ones.
Surface split_long_edges(const Surface& surface, double longest_edge);

// Fewer triangles of nearly the same shape by quadric edge collapse (Garland & Heckbert,
// SIGGRAPH 1997; VTK's implementation). `surface` and the result are closed. Throws InputError
// with the key "nodes" where the coarse surface is not a valid one or differs by more than 5 % in
// volume.
Surface decimate(const Surface& surface, int wanted_points);

}  // namespace hvp::mesh
