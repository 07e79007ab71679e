#pragma once

#include <map>
#include <utility>
#include <vector>

#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

using Edge = std::pair<int, int>;  // indices of points, the smaller one first
using TrianglesAtEdges = std::map<Edge, std::vector<int>>;

TrianglesAtEdges triangles_at_edges(const Surface& surface);

// The parts of a surface that hang together across edges of two triangles.
struct Patches {
  std::vector<int> of;  // of each triangle, counted from zero
  int count = 0;
  bool one_sided = false;  // no winding of one is alike everywhere, as of a Möbius strip
};

// Winds neighbours alike across edges of two triangles, each patch as its first triangle.
Patches wind_alike(Surface& surface, const TrianglesAtEdges& edges);

}  // namespace hvp::mesh
