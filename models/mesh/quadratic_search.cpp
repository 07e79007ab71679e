#include "models/mesh/quadratic_search.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/mesh/mid_edge_nodes.h"
#include "models/mesh/node_search.h"

namespace hvp::mesh {

namespace {

constexpr int kFewest = 10;  // the nodes of one tetrahedron
// Nodes a corner with which the search starts: those of TetGen's sphere of 500 nodes.
constexpr double kNodesACorner = 6;
constexpr double kNearEnough = 0.02;  // of the wanted count: the search ends there
constexpr int kMostMeshes = 24;

struct QuadraticFound {
  std::optional<TetMesh> mesh;  // within the accepted deviation
  std::set<int> counts;         // of all meshes that were made
  std::optional<InputError> refusal;
};

QuadraticFound search_corners(const std::function<TetMesh(int)>& mesh_with, int wanted) {
  QuadraticFound found;
  std::set<int> tried;
  double best = kAcceptedDeviation * wanted;
  int corners = std::max(4, static_cast<int>(std::lround(wanted / kNodesACorner)));
  const auto untried = [&tried](int from, int step) {
    while (tried.contains(from)) {
      if (from <= 4) step = 1;
      from += step;
    }
    return from;
  };
  for (int i = 0; i < kMostMeshes; ++i) {
    tried.insert(corners);
    std::optional<TetMesh> mesh;
    try {
      mesh = mesh_with(corners);
    } catch (const InputError& error) {
      if (error.key() != "nodes") throw;
      found.refusal = error;
      corners = untried(corners + 1, 1);
      continue;
    }
    const int made = static_cast<int>(mesh->nodes.size());
    *mesh = with_mid_edge_nodes(std::move(*mesh));
    const int count = static_cast<int>(mesh->nodes.size());
    found.counts.insert(count);
    const double deviation = std::abs(count - wanted);
    if (deviation <= best) {
      best = deviation;
      found.mesh = std::move(mesh);
    }
    if (deviation <= std::max(1.0, kNearEnough * wanted)) break;
    // Meshes of few nodes come in jumps: what would repeat one goes a corner further.
    const auto next = static_cast<int>(std::lround(static_cast<double>(made) * wanted / count));
    corners = untried(std::max(4, next), count < wanted ? 1 : -1);
  }
  return found;
}

}  // namespace

TetMesh mesh_with_mid_edge_nodes(const std::function<TetMesh(int corners)>& mesh_with, int wanted) {
  if (wanted < kFewest) {
    throw InputError("nodes", fmt::format("{} nodes are wanted; a quadratic tetrahedron has {}",
                                          wanted, kFewest));
  }
  QuadraticFound found = search_corners(mesh_with, wanted);
  if (found.mesh) return std::move(*found.mesh);
  const std::string refusal = fmt::format(
      "{} nodes cannot be reached within {:.0f} % for this body with quadratic elements", wanted,
      100.0 * kAcceptedDeviation);
  std::vector<int> offers(found.counts.begin(), found.counts.end());
  std::ranges::stable_sort(offers, {}, [&](int count) { return std::abs(count - wanted); });
  for (const int offer : offers) {
    if (!search_corners(mesh_with, offer).mesh) continue;
    throw InputError("nodes",
                     fmt::format("{}: expected {}, of which a mesh was made", refusal, offer));
  }
  throw InputError("nodes", found.refusal ? fmt::format("{}; of their corners: {}", refusal,
                                                        found.refusal->what())
                                          : refusal + ", and no other count was found");
}

}  // namespace hvp::mesh
