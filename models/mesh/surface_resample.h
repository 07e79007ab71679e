#pragma once

#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

// Halves every edge longer than `longest_edge` (m), the longest first, until none is left. The
// shape stays unchanged; long and flat triangles become shorter ones.
Surface split_long_edges(const Surface& surface, double longest_edge);

// Takes points away by collapsing edges, the shortest first, until `wanted_points` are left.
// `surface` is closed and consistently wound, and so is the result. A smooth patch keeps the
// volume under it; sharp edges (folds of more than 40°) and their corners stay in place; no
// collapse turns a triangle's normal by more than 45° or makes a needle of it, or a worse one.
// Throws InputError with the key "nodes" if the coarse surface intersects itself or the volume
// changes by more than 5
// %; returns more points than wanted if no edge can be collapsed.
Surface collapse_short_edges(const Surface& surface, int wanted_points);

// The same until no edge that can be collapsed is shorter than `shortest` (m): the rim of a
// cylinder with many sides gets fewer of them.
Surface collapse_edges_below(const Surface& surface, double shortest);

}  // namespace hvp::mesh
