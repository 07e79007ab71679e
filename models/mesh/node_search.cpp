#include "models/mesh/node_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/mesh/quality.h"
#include "models/mesh/smoothing.h"
#include "models/mesh/surface_check.h"
#include "models/mesh/tetgen_run.h"

namespace hvp::mesh {

namespace {

constexpr double kGoodEnough = 0.01;  // of the wanted count: the search ends there
constexpr int kMostRuns = 10;

// The volume bound for TetGen in units of the regular tetrahedron whose edge is the surface's:
// with 2.6 the elements inside are about as large as those at the surface, and a sphere of 500
// nodes has 38.6 non-zeros a row.
constexpr double kVolumeFactor = 2.6;
constexpr double kRegularTetrahedron = 0.11785113019775793;  // 1/(6√2), volume for edge 1

// TetGen's -q: largest ratio of circumradius to shortest edge. Where the surface's triangles are
// uneven, 1.2 takes more nodes than are wanted, and looser bounds are tried.
constexpr std::array<double, 3> kRadiusEdgeRatios{1.2, 1.4, 1.8};

int nodes_of(const TetMesh& mesh) { return static_cast<int>(mesh.nodes.size()); }

class Search {
 public:
  Search(int wanted, const Progress& progress) : wanted_(wanted), progress_(progress) {}

  // Keeps the surface and varies the volume bound: regula falsi on the logarithms once the count
  // is bracketed, since the count goes with a power of the bound. Returns the mesh nearest to the
  // wanted count, if it is accepted.
  std::optional<TetMesh> vary_volume_bound(const Surface& surface, double edge, double ratio) {
    const double target = std::log(static_cast<double>(wanted_));
    // A bound as large as the body is none.
    const double no_bound = std::log(enclosed_volume(surface));
    double x =
        std::min(no_bound, std::log(kVolumeFactor * kRegularTetrahedron) + 3 * std::log(edge));
    std::optional<std::pair<double, double>> above;  // (log bound, log count), too many nodes
    std::optional<std::pair<double, double>> below;
    int unchanged = 0;
    best_.reset();
    for (int run = 0; run < kMostRuns; ++run) {
      const double y = std::log(static_cast<double>(
          attempt(surface, {.max_volume = std::exp(x), .radius_edge_ratio = ratio})));
      if (deviation() <= std::max(1.0, kGoodEnough * wanted_)) break;
      unchanged = below && below->second == y ? unchanged + 1 : 0;
      if (unchanged == 2) break;  // the surface's triangles admit no more nodes
      (y > target ? above : below) = {x, y};
      if (above && below) {
        const double span = below->first - above->first;
        const double share = (above->second - target) / (above->second - below->second);
        x = above->first + std::clamp(share, 0.15, 0.85) * span;
        if (std::abs(span) < 1e-3) break;
      } else if (above) {
        if (x >= no_bound) break;  // the surface is too fine
        x = no_bound;
      } else {
        x -= std::max(1.2 * (target - y), 0.2);
      }
    }
    if (deviation() > kAcceptedDeviation * wanted_) return std::nullopt;
    return std::exchange(best_, std::nullopt);
  }

  void note(int count) {
    fewest_ = std::min(fewest_, count);
    most_ = std::max(most_, count);
    if (nearest_ == 0 || std::abs(count - wanted_) < std::abs(nearest_ - wanted_)) nearest_ = count;
  }

  [[noreturn]] void refuse() const {
    throw InputError("nodes",
                     fmt::format("{} nodes cannot be reached within {:.0f} % for this body: the "
                                 "nearest mesh has {}, those tried had {} to {}",
                                 wanted_, 100.0 * kAcceptedDeviation, nearest_, fewest_, most_));
  }

 private:
  double deviation() const { return std::abs(nodes_of(*best_) - wanted_); }

  int attempt(const Surface& surface, const TetgenOptions& options) {
    TetMesh mesh = run_tetgen(surface, options);
    const int count = nodes_of(mesh);
    note(count);
    if (progress_) progress_(fmt::format("meshing: {} nodes, wanted {}", count, wanted_));
    if (!best_ || std::abs(count - wanted_) < deviation()) best_ = std::move(mesh);
    return count;
  }

  int wanted_;
  const Progress& progress_;
  std::optional<TetMesh> best_;
  int nearest_ = 0;
  int fewest_ = std::numeric_limits<int>::max();
  int most_ = 0;
};

}  // namespace

double edge_length_for(double volume, double area, int nodes) {
  const auto count = [&](double edge) {
    return 2.0 + 0.703 * area / (edge * edge) + 0.930 * volume / (edge * edge * edge);
  };
  double low = 1e-4 * std::cbrt(volume);
  double high = 10.0 * std::cbrt(volume);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (count(middle) > nodes ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

int points_for(double area, double edge) {
  // An equilateral triangle has the area √3/4·L², and there are 2(points − 2) of them.
  return static_cast<int>(std::lround(2.0 + 1.1547005383792517 * area / (edge * edge)));
}

TetMesh mesh_first_that_fits(const std::vector<Candidate>& candidates, int wanted,
                             const Progress& progress) {
  Search search(wanted, progress);
  std::optional<InputError> refusal;
  std::optional<TetMesh> best;
  std::size_t fewest_slivers = std::numeric_limits<std::size_t>::max();
  for (const Candidate& candidate : candidates) {
    Surface surface;
    try {
      surface = candidate.surface();
    } catch (const InputError& error) {
      refusal = error;
      continue;
    }
    const int points = static_cast<int>(surface.points.size());
    if (points > (1.0 + kAcceptedDeviation) * wanted) {
      search.note(points);
      continue;
    }
    for (const double ratio : kRadiusEdgeRatios) {
      if (ratio > kRadiusEdgeRatios[0] && (best || !candidate.loose_ratio)) break;
      std::optional<TetMesh> mesh = search.vary_volume_bound(surface, candidate.edge, ratio);
      if (!mesh) continue;
      smooth(*mesh);
      const std::size_t slivers = measure(*mesh).slivers;
      if (slivers == 0) return std::move(*mesh);
      if (slivers < fewest_slivers) {
        fewest_slivers = slivers;
        best = std::move(mesh);
      }
    }
  }
  if (best) return std::move(*best);
  if (refusal) throw InputError(*refusal);
  search.refuse();
}

}  // namespace hvp::mesh
