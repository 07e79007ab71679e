#include "models/mesh/generate.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/mesh/node_search.h"
#include "models/mesh/parametric_surface.h"
#include "models/mesh/quadratic_search.h"
#include "models/mesh/surface_check.h"
#include "models/mesh/surface_reader.h"
#include "models/mesh/surface_resample.h"

namespace hvp::mesh {

namespace {

// Edges of a surface longer than this many target edges are halved: the boundary would otherwise
// be much coarser than the inside. The other figures are second choices.
constexpr std::array<double, 5> kLongestEdges{1.6, 1.3, 1.1, 0.9, 2.0};

// A user's surface with more than this many times the suitable number of points is coarsened
// first: kept as it is, it would leave the inside with too few nodes or with none.
constexpr double kTooFine = 1.5;

// A sphere can have any number of points: they go with the edge length inside.
TetMesh mesh_sphere(double radius, int wanted_nodes, const Progress& progress) {
  const double area = 4.0 * std::numbers::pi * radius * radius;
  const double volume = area * radius / 3.0;
  const auto candidates_for = [&](int wanted) {
    const double edge = edge_length_for(volume, area, wanted);
    std::vector<Candidate> candidates;
    for (const double factor : {1.0, 1.05, 0.95, 1.1, 1.2, 0.9, 1.35}) {
      const int points = std::max(4, points_for(area, factor * edge));
      candidates.push_back({[=] { return sphere_surface(radius, points); }, edge, false});
    }
    return candidates;
  };
  return mesh_first_that_fits(candidates_for, wanted_nodes, progress);
}

TetMesh mesh_box(const Eigen::Vector3d& size, int wanted_nodes, const Progress& progress) {
  const double volume = size.x() * size.y() * size.z();
  const double area = 2.0 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
  const auto candidates_for = [&](int wanted) {
    const double edge = edge_length_for(volume, area, wanted);
    std::vector<Candidate> candidates;
    // A cell of 0.93 edges has the area of two equilateral triangles. The last resort is a surface
    // without a grid, which can have any number of points.
    for (const double cell : {0.93, 1.0, 0.87, 1.1, 0.8, 1.2}) {
      candidates.push_back({[=] { return box_surface(size, cell * edge); }, edge, false});
    }
    for (const double longest : kLongestEdges) {
      const auto split = [=] {
        return split_long_edges(box_surface(size, size.maxCoeff()), longest * edge);
      };
      candidates.push_back({split, edge});
    }
    return candidates;
  };
  return mesh_first_that_fits(candidates_for, wanted_nodes, progress);
}

// The candidates for a user's surface, which keep its triangles, or split or collapse its edges.
class SurfaceCandidates {
 public:
  SurfaceCandidates(const Surface& surface, const Progress& progress)
      : surface_(surface),
        progress_(progress),
        area_(surface_area(surface)),
        volume_(enclosed_volume(surface)) {}

  std::vector<Candidate> operator()(int wanted) const {
    const double edge = edge_length_for(volume_, area_, wanted);
    const int suitable = points_for(area_, edge);
    std::vector<Candidate> candidates;
    if (points() > kTooFine * suitable) {
      coarsen(candidates, suitable, edge);
      candidates.push_back({[this] { return surface_; }, edge});
    } else if (has_needles()) {
      coarsen_rims(candidates, edge);
      resample(candidates, suitable, edge);
      split(candidates, edge);
    } else {
      split(candidates, edge);
      coarsen(candidates, suitable, edge);
    }
    if (!has_needles()) resample(candidates, suitable, edge);
    refine(candidates, edge);
    return candidates;
  }

 private:
  // True if more than a tenth of the triangles are as long and thin as those of a fan, of which
  // splitting would make many points.
  bool has_needles() const {
    constexpr double kThin = 0.15;  // twice the area over the square of the longest edge
    std::size_t thin = 0;
    for (const auto& t : surface_.triangles) {
      const auto corner = [&](std::size_t k) -> const Eigen::Vector3d& {
        return surface_.points[static_cast<std::size_t>(t[k])];
      };
      const Eigen::Vector3d a = corner(1) - corner(0);
      const Eigen::Vector3d b = corner(2) - corner(0);
      const double longest = std::max({a.squaredNorm(), b.squaredNorm(), (a - b).squaredNorm()});
      if (a.cross(b).norm() < kThin * longest) ++thin;
    }
    return 10 * thin > surface_.triangles.size();
  }
  int points() const { return static_cast<int>(surface_.points.size()); }

  void split(std::vector<Candidate>& candidates, double edge) const {
    for (const double longest : kLongestEdges) {
      candidates.push_back(
          {[this, longest, edge] { return split_long_edges(surface_, longest * edge); }, edge});
    }
  }

  void coarsen(std::vector<Candidate>& candidates, int suitable, double edge) const {
    for (const double share : {1.0, 0.9, 1.15, 0.8}) {
      const int fewer = std::max(4, static_cast<int>(share * suitable));
      if (fewer >= points()) continue;
      const auto collapse = [this, fewer] {
        if (progress_) {
          progress_(fmt::format("coarsening the surface from {} to {} points", points(), fewer));
        }
        return collapse_short_edges(surface_, fewer);
      };
      candidates.push_back({collapse, edge});
    }
  }

  // Of long facets with short ends, as a CAD program makes of a cylinder, the ends are made as long
  // as suits, and then the facets split along their length.
  void coarsen_rims(std::vector<Candidate>& candidates, double edge) const {
    for (const double shortest : {0.8, 0.6, 0.45, 0.3}) {
      for (const double longest : {1.5, 1.2}) {
        const auto even = [this, shortest, longest, edge] {
          return split_long_edges(collapse_edges_below(surface_, shortest * edge), longest * edge);
        };
        candidates.push_back({even, edge});
      }
    }
  }

  // Long facets with short ends, as a CAD program makes of a cylinder, split into many points where
  // their corners meet: they are split finely and then collapsed evenly.
  void resample(std::vector<Candidate>& candidates, int suitable, double edge) const {
    constexpr double kFine = 0.7;  // of the edge
    // A fan of long needles becomes so many points that collapsing them takes minutes.
    constexpr int kMostTimes = 40;
    for (const double share : {1.0, 0.85, 0.7, 0.55}) {
      const int fewer = std::max(4, static_cast<int>(share * suitable));
      const auto even = [this, fewer, suitable, edge] {
        Surface fine = split_long_edges(surface_, kFine * edge);
        const int most = kMostTimes * suitable;
        if (static_cast<int>(fine.points.size()) > most) {
          throw InputError("nodes", fmt::format("split for {} points the surface has {}: at most "
                                                "{} are collapsed",
                                                fewer, fine.points.size(), most));
        }
        if (fewer >= static_cast<int>(fine.points.size())) return fine;
        if (progress_) {
          progress_(fmt::format("resampling the surface from {} to {} points", fine.points.size(),
                                fewer));
        }
        return collapse_short_edges(fine, fewer);
      };
      candidates.push_back({even, edge});
    }
  }

  // The last resort: TetGen adds points on the surface where it needs them.
  void refine(std::vector<Candidate>& candidates, double edge) const {
    Candidate as_it_is{[this] { return surface_; }, edge};
    as_it_is.keep_surface = false;
    candidates.push_back(as_it_is);
  }

  const Surface& surface_;
  const Progress& progress_;
  double area_;
  double volume_;
};

}  // namespace

TetMesh generate(const MeshSettings& settings, const Progress& progress) {
  settings.check();
  if (settings.shape == MeshSettings::Shape::surface) {
    if (progress) progress("reading the surface");
    return tetrahedralise(read_surface(settings.surface.path, settings.surface_unit),
                          settings.nodes, progress, settings.quadratic);
  }
  const auto mesh_with = [&](int nodes) {
    return settings.shape == MeshSettings::Shape::sphere
               ? mesh_sphere(settings.radius, nodes, progress)
               : mesh_box(settings.size, nodes, progress);
  };
  return settings.quadratic ? mesh_with_mid_edge_nodes(mesh_with, settings.nodes)
                            : mesh_with(settings.nodes);
}

TetMesh tetrahedralise(const Surface& raw, int wanted_nodes, const Progress& progress,
                       bool quadratic) {
  if (wanted_nodes < 4) {
    throw InputError("nodes",
                     fmt::format("{} nodes are wanted; a tetrahedron has 4", wanted_nodes));
  }
  const Surface surface = check_surface(raw);
  const SurfaceCandidates candidates(surface, progress);
  const auto mesh_with = [&](int nodes) {
    return mesh_first_that_fits(candidates, nodes, progress);
  };
  return quadratic ? mesh_with_mid_edge_nodes(mesh_with, wanted_nodes) : mesh_with(wanted_nodes);
}

}  // namespace hvp::mesh
