#include "models/mesh/mid_edge_nodes.h"

#include <algorithm>
#include <utility>

#include "models/index.h"

namespace hvp::mesh {

namespace {

using Edge = std::pair<int, int>;  // the lower end first

Edge edge_between(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

std::vector<Edge> edges_of(const TetMesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(6 * mesh.tetrahedra.size());
  for (const auto& t : mesh.tetrahedra) {
    for (const auto& ends : kTetEdges) edges.push_back(edge_between(t[ends[0]], t[ends[1]]));
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

}  // namespace

TetMesh with_mid_edge_nodes(TetMesh mesh) {
  const std::vector<Edge> edges = edges_of(mesh);
  const int corners = static_cast<int>(mesh.nodes.size());
  const auto middle = [&](int a, int b) {
    const auto found = std::lower_bound(edges.begin(), edges.end(), edge_between(a, b));
    return corners + static_cast<int>(found - edges.begin());
  };
  mesh.nodes.reserve(mesh.nodes.size() + edges.size());
  for (const auto& [a, b] : edges) {
    mesh.nodes.emplace_back(0.5 * (mesh.nodes[at(a)] + mesh.nodes[at(b)]));
  }
  mesh.mid_edge.reserve(mesh.tetrahedra.size());
  for (const auto& t : mesh.tetrahedra) {
    std::array<int, 6> middles{};
    for (std::size_t k = 0; k < 6; ++k) middles[k] = middle(t[kTetEdges[k][0]], t[kTetEdges[k][1]]);
    mesh.mid_edge.push_back(middles);
  }
  std::vector<std::array<int, 3>> boundary;
  boundary.reserve(4 * mesh.boundary.size());
  for (const auto& [a, b, c] : mesh.boundary) {
    const int ab = middle(a, b);
    const int bc = middle(b, c);
    const int ca = middle(c, a);
    boundary.push_back({a, ab, ca});
    boundary.push_back({b, bc, ab});
    boundary.push_back({c, ca, bc});
    boundary.push_back({ab, bc, ca});
  }
  mesh.boundary = std::move(boundary);
  return mesh;
}

}  // namespace hvp::mesh
