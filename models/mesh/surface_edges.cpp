#include "models/mesh/surface_edges.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "models/index.h"

namespace hvp::mesh {

namespace {

bool runs_along(const std::array<int, 3>& t, int from, int to) {
  return (t[0] == from && t[1] == to) || (t[1] == from && t[2] == to) ||
         (t[2] == from && t[0] == to);
}

}  // namespace

TrianglesAtEdges triangles_at_edges(const Surface& surface) {
  TrianglesAtEdges edges;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const auto& t = surface.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) {
      edges[std::minmax(t[k], t[(k + 1) % 3])].push_back(static_cast<int>(i));
    }
  }
  return edges;
}

Patches wind_alike(Surface& surface, const TrianglesAtEdges& edges) {
  Patches patches;
  patches.of.assign(surface.triangles.size(), -1);
  for (std::size_t seed = 0; seed < patches.of.size(); ++seed) {
    if (patches.of[seed] >= 0) continue;
    std::vector<int> pending{static_cast<int>(seed)};
    patches.of[seed] = patches.count;
    while (!pending.empty()) {
      const int current = pending.back();
      pending.pop_back();
      const auto t = surface.triangles[at(current)];
      for (std::size_t k = 0; k < 3; ++k) {
        const int a = t[k];
        const int b = t[(k + 1) % 3];
        const auto& users = edges.at(std::minmax(a, b));
        if (users.size() != 2) continue;
        const int other = users[0] == current ? users[1] : users[0];
        auto& neighbour = surface.triangles[at(other)];
        const bool same_way = runs_along(neighbour, b, a);
        if (patches.of[at(other)] >= 0) {
          patches.one_sided = patches.one_sided || !same_way;
          continue;
        }
        if (!same_way) std::swap(neighbour[1], neighbour[2]);
        patches.of[at(other)] = patches.count;
        pending.push_back(other);
      }
    }
    ++patches.count;
  }
  return patches;
}

}  // namespace hvp::mesh
