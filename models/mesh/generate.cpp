#include "models/mesh/generate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/mesh/byte_stream.h"
#include "models/mesh/child_process.h"
#include "models/mesh/parametric_surface.h"
#include "models/mesh/smoothing.h"
#include "models/mesh/surface_check.h"
#include "models/mesh/surface_reader.h"
#include "models/mesh/surface_resample.h"
#include "models/mesh/tetgen_run.h"

namespace hvp::mesh {

namespace {

constexpr double kAccepted = 0.10;  // of the wanted count: beyond that the count is refused
constexpr double kGoodEnough = 0.01;
constexpr int kMostRuns = 10;

// The volume bound for TetGen in units of the regular tetrahedron whose edge is the surface's:
// with 2.6 the elements inside are about as large as those at the surface, and a sphere of 500
// nodes has 38.6 non-zeros a row.
constexpr double kVolumeFactor = 2.6;
constexpr double kRegularTetrahedron = 0.11785113019775793;  // 1/(6√2), volume for edge 1

// TetGen's -q: largest ratio of circumradius to shortest edge. Where the surface's triangles are
// uneven, 1.2 takes more nodes than are wanted, and looser bounds are tried.
constexpr std::array<double, 3> kRadiusEdgeRatios{1.2, 1.4, 1.8};

// Edges of a surface longer than this many target edges are halved: the boundary would otherwise
// be much coarser than the inside.
constexpr double kLongestEdge = 1.6;

// A user's surface with more than this many times the suitable number of points is coarsened
// first: kept as it is, it would leave the inside with too few nodes or with none.
constexpr double kTooFine = 1.5;

int nodes_of(const TetMesh& mesh) { return static_cast<int>(mesh.nodes.size()); }

// The edge length for which a body of this volume and area gets `nodes` nodes:
// n = 2 + 0.703·A/L² + 0.930·V/L³, fitted to TetGen's meshes of a sphere with 100 to 900 points
// on it at the volume bound above; it is off by 2 % at most there, and only starts the search.
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

double volume_bound(double edge) {
  return kVolumeFactor * kRegularTetrahedron * edge * edge * edge;
}

// The best mesh of a search so far, and what was seen on the way.
class Search {
 public:
  Search(int wanted, const Progress& progress) : wanted_(wanted), progress_(progress) {}

  // Returns the node count of this attempt.
  int attempt(const Surface& surface, const TetgenOptions& options) {
    TetMesh mesh = run_tetgen(surface, options);
    const int count = nodes_of(mesh);
    ++runs_;
    note(count);
    if (progress_) progress_(fmt::format("meshing: {} nodes, wanted {}", count, wanted_));
    if (!best_ || std::abs(count - wanted_) < std::abs(nodes_of(*best_) - wanted_)) {
      best_ = std::move(mesh);
    }
    return count;
  }

  bool done() const {
    return best_ && std::abs(nodes_of(*best_) - wanted_) <= std::max(1.0, kGoodEnough * wanted_);
  }
  bool accepted() const {
    return best_ && std::abs(nodes_of(*best_) - wanted_) <= kAccepted * wanted_;
  }
  bool exhausted() const { return runs_ >= kMostRuns; }
  void grant_more_runs() { runs_ = 0; }
  // A count that a surface has from the start and that is already too many.
  void note(int count) {
    fewest_ = std::min(fewest_, count);
    most_ = std::max(most_, count);
    if (nearest_ == 0 || std::abs(count - wanted_) < std::abs(nearest_ - wanted_)) nearest_ = count;
  }

  TetMesh result() {
    if (!accepted()) {
      throw InputError(
          "nodes", fmt::format("{} nodes cannot be reached within 10 % for this body: the nearest "
                               "mesh has {}, those tried had {} to {}",
                               wanted_, nearest_, fewest_, most_));
    }
    smooth(*best_);
    return std::move(*best_);
  }

 private:
  int wanted_;
  const Progress& progress_;
  std::optional<TetMesh> best_;
  int runs_ = 0;
  int fewest_ = std::numeric_limits<int>::max();
  int most_ = 0;
  int nearest_ = 0;
};

// Keeps the surface and varies the volume bound: regula falsi on the logarithms once the count is
// bracketed, since the count goes with a power of the bound.
void search_volume_bound(Search& search, const Surface& surface, double start, int wanted,
                         double radius_edge_ratio) {
  double x = std::log(start);
  std::optional<std::pair<double, double>> above;  // (log bound, log count) with too many nodes
  std::optional<std::pair<double, double>> below;
  int unchanged = 0;
  const double target = std::log(static_cast<double>(wanted));
  while (!search.done() && !search.exhausted()) {
    const double y = std::log(static_cast<double>(search.attempt(
        surface, {.max_volume = std::exp(x), .radius_edge_ratio = radius_edge_ratio})));
    unchanged = below && below->second == y ? unchanged + 1 : 0;
    if (unchanged == 2) return;  // the surface's triangles admit no more nodes
    (y > target ? above : below) = {x, y};
    if (above && below) {
      const double span = below->first - above->first;
      const double share = (above->second - target) / (above->second - below->second);
      x = above->first + std::clamp(share, 0.15, 0.85) * span;
      if (std::abs(span) < 1e-3) return;
    } else if (above) {
      // Raising the bound beyond the whole body changes nothing any more.
      if (std::exp(x) > enclosed_volume(surface)) return;
      x += std::log(8.0);
    } else {
      x -= std::max(1.2 * (target - y), 0.2);
    }
  }
}

// A surface of any resolution can be had: vary it together with the volume bound, so that the
// elements at the surface and inside stay alike.
TetMesh mesh_sphere(double radius, int wanted, const Progress& progress) {
  Search search(wanted, progress);
  const double area = 4.0 * 3.14159265358979323846 * radius * radius;
  const double volume = area * radius / 3.0;
  int effective = wanted;
  Surface surface;
  double edge = 0.0;
  for (int run = 0; run < 4 && !search.done(); ++run) {
    edge = edge_length_for(volume, area, std::max(effective, 4));
    // 2(points − 2) equilateral triangles cover the area.
    const int points = static_cast<int>(std::lround(2.0 + 1.1547 * area / (edge * edge)));
    surface = sphere_surface(radius, std::max(points, 4));
    const int count = search.attempt(surface, {.max_volume = volume_bound(edge)});
    effective =
        static_cast<int>(std::lround(static_cast<double>(effective) * wanted / std::max(count, 1)));
  }
  if (!search.done()) {
    search_volume_bound(search, surface, volume_bound(edge), wanted, kRadiusEdgeRatios[0]);
  }
  return search.result();
}

// TetGen keeps the surface (Y) and puts no node into the smallest sphere around one of its
// triangles, so a coarse surface bounds the count from above and a fine one from below. The
// surfaces are tried one after the other until the count is met.
TetMesh mesh_first_that_fits(const std::vector<std::function<Surface()>>& candidates, double edge,
                             int wanted, const Progress& progress) {
  Search search(wanted, progress);
  std::optional<InputError> refusal;
  for (const auto& candidate : candidates) {
    if (search.accepted()) break;
    Surface surface;
    try {
      surface = candidate();
    } catch (const InputError& error) {
      refusal = error;
      continue;
    }
    if (static_cast<double>(surface.points.size()) > (1.0 + kAccepted) * wanted) {
      search.note(static_cast<int>(surface.points.size()));
      continue;
    }
    for (const double ratio : kRadiusEdgeRatios) {
      if (search.accepted()) break;
      search.grant_more_runs();
      search_volume_bound(search, surface, volume_bound(edge), wanted, ratio);
    }
  }
  if (!search.accepted() && refusal) throw InputError(*refusal);
  return search.result();
}

TetMesh mesh_box(const Eigen::Vector3d& size, int wanted, const Progress& progress) {
  const double volume = size.x() * size.y() * size.z();
  const double area = 2.0 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
  const double edge = edge_length_for(volume, area, wanted);
  std::vector<std::function<Surface()>> candidates;
  // A cell of 0.93 edges has the area of two equilateral triangles. The last resort is a surface
  // without a grid, which can have any number of points.
  for (const double cell : {0.93, 1.1, 0.8}) {
    candidates.emplace_back([=] { return box_surface(size, cell * edge); });
  }
  for (const double longest : {kLongestEdge, 1.3, 1.1, 0.9, 2.0}) {
    candidates.emplace_back(
        [=] { return split_long_edges(box_surface(size, size.maxCoeff()), longest * edge); });
  }
  return mesh_first_that_fits(candidates, edge, wanted, progress);
}

TetMesh mesh_surface(const Surface& raw, int wanted, const Progress& progress) {
  const Surface surface = check_surface(raw);
  const double volume = enclosed_volume(surface);
  const double area = surface_area(surface);
  const double edge = edge_length_for(volume, area, wanted);
  const int points = static_cast<int>(surface.points.size());
  const int suitable = static_cast<int>(2.0 + 1.1547 * area / (edge * edge));
  std::vector<std::function<Surface()>> candidates;
  const auto split = [&] {
    for (const double longest : {kLongestEdge, 1.3, 1.1, 0.9, 2.0}) {
      candidates.emplace_back([&, longest] { return split_long_edges(surface, longest * edge); });
    }
  };
  const auto coarsen = [&] {
    for (const double share : {1.0, 0.8, 1.2}) {
      candidates.emplace_back([&, share] {
        const int fewer = std::max(4, static_cast<int>(share * suitable));
        if (progress) {
          progress(fmt::format("coarsening the surface from {} to {} points", points, fewer));
        }
        return collapse_short_edges(surface, fewer);
      });
    }
  };
  if (points > kTooFine * suitable) {
    coarsen();
    candidates.emplace_back([&] { return surface; });
  } else {
    split();
    if (points > suitable) coarsen();
  }
  return mesh_first_that_fits(candidates, edge, wanted, progress);
}

// A mesh of a million nodes takes TetGen a minute or two, and a search needs a few.
ChildLimits limits_for(int nodes) {
  return {.cpu_seconds = 60 + nodes / 1000, .memory_bytes = std::size_t{8} << 30};
}

template <class Work>
TetMesh mesh_in_child(int wanted, const Progress& progress, const Work& work) {
  const std::string bytes = run_in_child("the mesher", "surface", limits_for(wanted), progress,
                                         [&](const Progress& inner) {
                                           const TetMesh mesh = work(inner);
                                           ByteWriter writer;
                                           writer.points(mesh.nodes);
                                           writer.tuples(mesh.tetrahedra);
                                           writer.tuples(mesh.boundary);
                                           return writer.bytes();
                                         });
  ByteReader reader(bytes);
  TetMesh mesh;
  mesh.nodes = reader.points();
  mesh.tetrahedra = reader.tuples<4>();
  mesh.boundary = reader.tuples<3>();
  return mesh;
}

}  // namespace

TetMesh generate(const MeshSettings& settings, const Progress& progress) {
  settings.check();
  switch (settings.shape) {
    case MeshSettings::Shape::sphere:
      return mesh_in_child(settings.nodes, progress, [&](const Progress& inner) {
        return mesh_sphere(settings.radius, settings.nodes, inner);
      });
    case MeshSettings::Shape::box:
      return mesh_in_child(settings.nodes, progress, [&](const Progress& inner) {
        return mesh_box(settings.size, settings.nodes, inner);
      });
    case MeshSettings::Shape::surface:
      break;
  }
  if (progress) progress("reading the surface");
  return tetrahedralise(read_surface(settings.surface, settings.surface_unit), settings.nodes,
                        progress);
}

TetMesh tetrahedralise(const Surface& surface, int wanted_nodes, const Progress& progress) {
  if (wanted_nodes < 4) {
    throw InputError("nodes",
                     fmt::format("{} nodes are wanted; a tetrahedron has 4", wanted_nodes));
  }
  return mesh_in_child(wanted_nodes, progress, [&](const Progress& inner) {
    return mesh_surface(surface, wanted_nodes, inner);
  });
}

}  // namespace hvp::mesh
