#include "models/mesh/surface_repair.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkIdList.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStaticCellLocator.h>

#include "models/config/input_error.h"
#include "models/index.h"
#include "models/mesh/surface_check.h"
#include "models/mesh/surface_edges.h"
#include "models/mesh/surface_resample.h"
#include "models/mesh/winding_number.h"

namespace hvp::mesh {

namespace {

using Eigen::Vector3d;

constexpr double kDetails = 100;  // of the diagonal
// Around the body, so that its surface does not leave the grid.
constexpr int kMargin = 3;
// Points of a coarsened surface: fewer would be no likeness of a body.
constexpr int kFewestPoints = 300;
// Where the surface passes a point of the grid, it is kept so far away from it: closer it would cut
// needles off.
constexpr double kLeast = 0.15;  // of the spacing
// An edge of the grid's surface that is shorter makes a sliver.
constexpr double kShortest = 0.5;  // of the spacing

vtkNew<vtkPolyData> to_vtk(const Surface& surface) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const Vector3d& x : surface.points) points->InsertNextPoint(x.data());
  vtkNew<vtkCellArray> cells;
  for (const auto& t : surface.triangles) {
    cells->InsertNextCell({vtkIdType{t[0]}, vtkIdType{t[1]}, vtkIdType{t[2]}});
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetPolys(cells);
  return data;
}

Surface from_vtk(vtkPolyData& data) {
  Surface surface;
  for (vtkIdType i = 0; i < data.GetNumberOfPoints(); ++i) {
    Vector3d x;
    data.GetPoint(i, x.data());
    surface.points.push_back(x);
  }
  vtkNew<vtkIdList> corners;
  data.GetPolys()->InitTraversal();
  while (data.GetPolys()->GetNextCell(corners) != 0) {
    surface.triangles.push_back({static_cast<int>(corners->GetId(0)),
                                 static_cast<int>(corners->GetId(1)),
                                 static_cast<int>(corners->GetId(2))});
  }
  return surface;
}

// Distances from a surface.
class Distance {
 public:
  explicit Distance(const Surface& surface) : data_(to_vtk(surface)) {
    locator_->SetDataSet(data_);
    locator_->BuildLocator();
  }
  double of(const Vector3d& x) {
    Vector3d closest;
    vtkIdType cell = 0;
    int part = 0;
    double squared = 0;
    locator_->FindClosestPoint(x.data(), closest.data(), cell, part, squared);
    return std::sqrt(squared);
  }

 private:
  vtkNew<vtkPolyData> data_;
  vtkNew<vtkStaticCellLocator> locator_;
};

// Whether it has an inside: every edge belongs to two triangles.
bool is_closed(const TrianglesAtEdges& edges) {
  return std::ranges::all_of(edges, [](const auto& edge) { return edge.second.size() == 2; });
}

// Winds each patch outwards, since the winding number sums what turns one way. Of one with a rim
// that is as its own middle sees it.
Surface wound_outwards(Surface surface, const TrianglesAtEdges& edges) {
  const Patches patches = wind_alike(surface, edges);
  std::vector<Vector3d> middle(at(patches.count), Vector3d::Zero());
  std::vector<double> triangles(middle.size());
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    middle[at(patches.of[i])] += surface.points[at(surface.triangles[i][0])];
    ++triangles[at(patches.of[i])];
  }
  for (std::size_t patch = 0; patch < middle.size(); ++patch) middle[patch] /= triangles[patch];
  std::vector<double> volume(middle.size());  // six times
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const auto& t = surface.triangles[i];
    const std::size_t patch = at(patches.of[i]);
    volume[patch] += jacobian_determinant(middle[patch], surface.points[at(t[0])],
                                          surface.points[at(t[1])], surface.points[at(t[2])]);
  }
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    auto& t = surface.triangles[i];
    if (volume[at(patches.of[i])] < 0) std::swap(t[1], t[2]);
  }
  return surface;
}

// A grid around a surface.
struct Grid {
  Vector3d origin;
  double spacing = 0;
  std::array<int, 3> count = {};

  std::size_t points() const { return at(count[0]) * at(count[1]) * at(count[2]); }
  Vector3d place(std::size_t index) const {
    const std::size_t row = index / at(count[0]);
    const std::size_t i = index % at(count[0]);
    const std::size_t j = row % at(count[1]);
    const std::size_t k = row / at(count[1]);
    return origin + spacing * Vector3d(static_cast<double>(i), static_cast<double>(j),
                                       static_cast<double>(k));
  }
};

Grid grid_around(const Surface& raw, double detail) {
  const Eigen::AlignedBox3d box = box_around(raw.points);
  Grid grid;
  grid.spacing = detail > 0 ? detail : box.diagonal().norm() / kDetails;
  // A flat side between two planes of the grid meets no point of it.
  grid.origin = box.min() - (kMargin + 1 / std::numbers::pi) * Vector3d::Constant(grid.spacing);
  double points = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double cells = std::ceil(box.sizes()[axis] / grid.spacing) + 2 * kMargin + 1;
    points *= cells + 1;
    if (points > kMostGridPoints) {
      throw InputError("detail", fmt::format("{:.3g} mm takes a grid of more than {:.0f} million "
                                             "points: expected a coarser one",
                                             1e3 * grid.spacing, kMostGridPoints * 1e-6));
    }
    grid.count[at(axis)] = static_cast<int>(cells) + 1;
  }
  return grid;
}

// For every point of the grid its distance, negative inside. Across a hole, where there is no
// surface to be near to, the winding number itself tells how far inside a point is.
std::vector<double> signed_distances(const Surface& raw, const Grid& grid,
                                     const Progress& progress) {
  std::vector<double> distance(grid.points());
  Distance from(raw);
  const WindingNumber turns(raw);
  constexpr double kNear = 2;
  const double far = kNear * grid.spacing;
  const double least = kLeast * grid.spacing;
  for (std::size_t p = 0; p < distance.size(); ++p) {
    if (progress && p % 20'000 == 0) {
      progress(fmt::format("point {} of {} of the grid", p, distance.size()));
    }
    const Vector3d x = grid.place(p);
    // Of a surface that is wound inwards it is −1.
    const double outside = 0.5 - std::abs(turns.at_point(x));
    const double size = std::max(from.of(x), least);
    const double smooth = std::max(2 * far * std::abs(outside), least);
    distance[p] = std::copysign(size < far ? size : std::min(size, smooth), outside);
  }
  return distance;
}

Surface zero_surface(const Grid& grid, const std::vector<double>& distance) {
  vtkNew<vtkDoubleArray> values;
  values->SetNumberOfValues(static_cast<vtkIdType>(distance.size()));
  // VTK's triangles look to where the values are less.
  std::ranges::transform(distance, values->GetPointer(0), std::negate<>());
  vtkNew<vtkImageData> image;
  image->SetDimensions(grid.count.data());
  image->SetSpacing(grid.spacing, grid.spacing, grid.spacing);
  image->SetOrigin(grid.origin.x(), grid.origin.y(), grid.origin.z());
  image->GetPointData()->SetScalars(values);
  vtkNew<vtkFlyingEdges3D> edges;
  edges->SetInputData(image);
  edges->SetValue(0, 0.0);
  edges->ComputeNormalsOff();
  edges->ComputeGradientsOff();
  edges->ComputeScalarsOff();
  edges->Update();
  return from_vtk(*edges->GetOutput());
}

std::vector<Surface> shells_of(Surface surface) {
  const Patches patches = wind_alike(surface, triangles_at_edges(surface));
  std::vector<Surface> shells(at(patches.count));
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    shells[at(patches.of[i])].triangles.push_back(surface.triangles[i]);
  }
  for (Surface& shell : shells) {
    shell.points = surface.points;
    shell = merge_points(shell);
  }
  return shells;
}

// Without the slivers that the grid's planes cut off, which make bad tetrahedra.
Surface without_slivers(const Surface& cut, double spacing) {
  try {
    return check_surface(collapse_edges_below(cut, kShortest * spacing));
  } catch (const InputError&) {
    return cut;
  }
}

// About as many points as the triangles had, where that is possible.
Surface coarsened(const Surface& fine, std::size_t points) {
  const int wanted = std::max(kFewestPoints, static_cast<int>(points));
  if (static_cast<int>(fine.points.size()) <= wanted) return fine;
  try {
    return check_surface(collapse_short_edges(fine, wanted));
  } catch (const InputError&) {
    return fine;
  }
}

double area_of(const Surface& surface, const std::array<int, 3>& t) {
  const Vector3d& a = surface.points[at(t[0])];
  return 0.5 * (surface.points[at(t[1])] - a).cross(surface.points[at(t[2])] - a).norm();
}

// By points of every triangle that are hardly further apart than a detail.
double share_left(const Surface& old, Distance& from, double detail) {
  constexpr double kMost = 50;  // parts of a side
  double all = 0;
  double left = 0;
  for (const auto& t : old.triangles) {
    const Vector3d& a = old.points[at(t[0])];
    const Vector3d ab = old.points[at(t[1])] - a;
    const Vector3d ac = old.points[at(t[2])] - a;
    const double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
    const int parts = static_cast<int>(std::clamp(std::ceil(longest / detail), 1.0, kMost));
    const double area = area_of(old, t) / (parts * parts);
    // The centres of its parts, half of which stand on their heads.
    for (int i = 0; i < parts; ++i) {
      for (int j = 0; i + j < parts; ++j) {
        for (const double in_part : {1.0 / 3, 2.0 / 3}) {
          if (in_part > 0.5 && i + j + 1 == parts) continue;
          const Vector3d x = a + (i + in_part) / parts * ab + (j + in_part) / parts * ac;
          all += area;
          if (from.of(x) > 2 * detail) left += area;
        }
      }
    }
  }
  return all > 0 ? left / all : 0;
}

}  // namespace

RepairedSurface repair_surface(const Surface& raw, double detail, const Progress& progress) {
  check_numbers(raw);
  const TrianglesAtEdges edges = triangles_at_edges(raw);
  const Surface wound = wound_outwards(raw, edges);
  const Grid grid = grid_around(wound, detail);
  const Surface zero = zero_surface(grid, signed_distances(wound, grid, progress));
  std::vector<Surface> shells = shells_of(zero);
  const auto larger = [](const Surface& a, const Surface& b) {
    return enclosed_volume(a) < enclosed_volume(b);
  };
  const auto largest = std::ranges::max_element(shells, larger);
  if (largest == shells.end() || !(enclosed_volume(*largest) > 0)) {
    refuse(fmt::format("the triangles enclose nothing as large as the detail of {:.3g} mm",
                       1e3 * grid.spacing));
  }
  if (progress) progress("coarsening");
  RepairedSurface repaired;
  repaired.detail = grid.spacing;
  if (is_closed(edges)) repaired.old_volume = enclosed_volume(wound);
  try {
    repaired.surface =
        coarsened(without_slivers(check_surface(*largest), grid.spacing), wound.points.size());
  } catch (const InputError& e) {
    refuse(
        fmt::format("with a detail of {:.3g} mm no closed surface was found ({}): expected "
                    "another detail",
                    1e3 * grid.spacing, e.what()));
  }
  repaired.volume = enclosed_volume(repaired.surface);
  for (auto shell = shells.begin(); shell != shells.end(); ++shell) {
    if (shell == largest) continue;
    ++repaired.dropped_shells;
    repaired.dropped_volume += std::abs(enclosed_volume(*shell));
  }
  Distance from_old(wound);
  for (const Vector3d& x : repaired.surface.points) {
    repaired.moved = std::max(repaired.moved, from_old.of(x));
  }
  Distance from_new(repaired.surface);
  repaired.left_share = share_left(wound, from_new, grid.spacing);
  return repaired;
}

}  // namespace hvp::mesh
