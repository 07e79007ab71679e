#include "models/mesh/node_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <set>
#include <string>
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
// A mesh with more than so many times the wanted nodes is as good as one that has just as many.
constexpr int kMostTimes = 4;

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
  std::optional<TetMesh> vary_volume_bound(const Surface& surface, const Candidate& candidate,
                                           double ratio) {
    const double target = std::log(static_cast<double>(wanted_));
    // A bound as large as the body is none.
    const double no_bound = std::log(enclosed_volume(surface));
    double x = std::min(
        no_bound, std::log(kVolumeFactor * kRegularTetrahedron) + 3 * std::log(candidate.edge));
    std::optional<std::pair<double, double>> above;  // (log bound, log count), too many nodes
    std::optional<std::pair<double, double>> below;
    int unchanged = 0;
    best_.reset();
    for (int run = 0; run < kMostRuns; ++run) {
      const double y =
          std::log(static_cast<double>(attempt(surface, {.max_volume = std::exp(x),
                                                         .radius_edge_ratio = ratio,
                                                         .keep_surface = candidate.keep_surface,
                                                         .most_added = kMostTimes * wanted_})));
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

  void note(int count) { counts_.insert(count); }

  // The counts of all meshes and surfaces that were tried.
  const std::set<int>& counts() const { return counts_; }

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
  std::set<int> counts_;
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

namespace {

struct Found {
  std::optional<TetMesh> mesh;
  std::set<int> counts;  // that were seen
  std::optional<InputError> refusal;
};

Found search(const std::vector<Candidate>& candidates, int wanted, const Progress& progress) {
  Search search(wanted, progress);
  Found found;
  std::size_t fewest_slivers = std::numeric_limits<std::size_t>::max();
  for (const Candidate& candidate : candidates) {
    Surface surface;
    try {
      surface = candidate.surface();
    } catch (const InputError& error) {
      found.refusal = error;
      continue;
    }
    const int points = static_cast<int>(surface.points.size());
    if (points > (1.0 + kAcceptedDeviation) * wanted) {
      search.note(points);
      continue;
    }
    for (const double ratio : kRadiusEdgeRatios) {
      if (ratio > kRadiusEdgeRatios[0] && (found.mesh || !candidate.loose_ratio)) break;
      std::optional<TetMesh> mesh;
      try {
        mesh = search.vary_volume_bound(surface, candidate, ratio);
      } catch (const InputError& error) {
        found.refusal = error;
        break;
      }
      if (!mesh) continue;
      smooth(*mesh);
      const std::size_t slivers = measure(*mesh).slivers;
      if (slivers < fewest_slivers) {
        fewest_slivers = slivers;
        found.mesh = std::move(mesh);
      }
      if (slivers == 0) return found;
    }
  }
  found.counts = search.counts();
  return found;
}

}  // namespace

TetMesh mesh_first_that_fits(const Candidates& candidates, int wanted, const Progress& progress) {
  Found found = search(candidates(wanted), wanted, progress);
  if (found.mesh) return std::move(*found.mesh);
  if (found.counts.empty()) throw InputError(found.refusal.value());
  // The count of a mesh that was seen need not be one that can be asked for: it is asked for.
  constexpr std::size_t kMostOffers = 4;
  std::vector<int> offers(found.counts.begin(), found.counts.end());
  std::ranges::stable_sort(offers, {}, [&](int count) { return std::abs(count - wanted); });
  if (offers.size() > kMostOffers) offers.resize(kMostOffers);
  const std::string refusal =
      fmt::format("{} nodes cannot be reached within {:.0f} % for this body", wanted,
                  100.0 * kAcceptedDeviation);
  for (const int offer : offers) {
    if (progress) progress(fmt::format("meshing: looking whether {} nodes can be had", offer));
    if (!search(candidates(offer), offer, progress).mesh) continue;
    throw InputError("nodes",
                     fmt::format("{}: expected {}, of which a mesh was made", refusal, offer));
  }
  throw InputError("nodes",
                   fmt::format("{}, and no other count was found: the meshes tried had {} to {}",
                               refusal, *found.counts.begin(), *found.counts.rbegin()));
}

}  // namespace hvp::mesh
