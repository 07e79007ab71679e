#include "models/mesh/surface_repair.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
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
#include "models/mesh/surface_resample.h"

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

bool runs_along(const std::array<int, 3>& t, int from, int to) {
  return (t[0] == from && t[1] == to) || (t[1] == from && t[2] == to) ||
         (t[2] == from && t[0] == to);
}

using Edges = std::map<std::pair<int, int>, std::vector<int>>;

Edges edges_of(const Surface& surface) {
  Edges edges;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const auto& t = surface.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) {
      edges[std::minmax(t[k], t[(k + 1) % 3])].push_back(static_cast<int>(i));
    }
  }
  return edges;
}

// Whether it has an inside: every edge belongs to two triangles.
bool is_closed(const Edges& edges) {
  return std::ranges::all_of(edges, [](const auto& edge) { return edge.second.size() == 2; });
}

// Winds neighbours alike, across edges of two triangles, and each patch that hangs together so
// outward: the winding number sums what turns one way.
Surface wound_outwards(Surface surface, const Edges& edges) {
  std::vector<bool> seen(surface.triangles.size(), false);
  for (std::size_t seed = 0; seed < seen.size(); ++seed) {
    if (seen[seed]) continue;
    seen[seed] = true;
    std::vector<std::size_t> patch = {seed};
    for (std::size_t next = 0; next < patch.size(); ++next) {
      const std::array<int, 3> t = surface.triangles[patch[next]];
      for (std::size_t k = 0; k < 3; ++k) {
        const int a = t[k];
        const int b = t[(k + 1) % 3];
        const std::vector<int>& users = edges.at(std::minmax(a, b));
        if (users.size() != 2) continue;
        const std::size_t other = at(at(users[0]) == patch[next] ? users[1] : users[0]);
        if (seen[other]) continue;
        seen[other] = true;
        auto& neighbour = surface.triangles[other];
        if (!runs_along(neighbour, b, a)) std::swap(neighbour[1], neighbour[2]);
        patch.push_back(other);
      }
    }
    // Of a patch with a rim, as seen from its own middle.
    Vector3d middle = Vector3d::Zero();
    for (const std::size_t i : patch) middle += surface.points[at(surface.triangles[i][0])];
    middle /= static_cast<double>(patch.size());
    double volume = 0;
    for (const std::size_t i : patch) {
      const auto& t = surface.triangles[i];
      const Vector3d a = surface.points[at(t[0])] - middle;
      volume += a.dot((surface.points[at(t[1])] - middle).cross(surface.points[at(t[2])] - middle));
    }
    if (volume >= 0) continue;
    for (const std::size_t i : patch) {
      std::swap(surface.triangles[i][1], surface.triangles[i][2]);
    }
  }
  return surface;
}

// How often triangles turn around a point: the sum of their solid angles over 4π. Groups of them
// that are far away count as one dipole (Barill et al., SIGGRAPH 2018).
class WindingNumber {
 public:
  explicit WindingNumber(const Surface& surface)
      : surface_(surface), order_(surface.triangles.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    if (!order_.empty()) build(0, order_.size());
  }
  double at_point(const Vector3d& x) const {
    return group_.empty() ? 0 : angle(0, x) / (4 * std::numbers::pi);
  }

 private:
  // Twice the distance to a group of so large a radius: an error of some hundredths.
  static constexpr double kFar = 2;
  static constexpr std::size_t kLeaf = 8;

  struct Group {
    Vector3d centre = Vector3d::Zero();
    Vector3d area = Vector3d::Zero();  // the sum of the area vectors
    double radius = 0;
    std::size_t begin = 0, end = 0;  // of order_
    std::size_t right = 0;           // the second half; 0: none, a leaf
  };

  Vector3d corner(std::size_t triangle, std::size_t k) const {
    return surface_.points[at(surface_.triangles[triangle][k])];
  }
  Vector3d centre_of(std::size_t triangle) const {
    return (corner(triangle, 0) + corner(triangle, 1) + corner(triangle, 2)) / 3;
  }

  // The first half follows its group. Halves are split along the longest side of the centres' box.
  std::size_t build(std::size_t begin, std::size_t end) {
    const std::size_t index = group_.size();
    group_.emplace_back();
    Group group;
    group.begin = begin;
    group.end = end;
    Eigen::AlignedBox3d centres;
    double weights = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Vector3d a = corner(order_[i], 0);
      const Vector3d twice = (corner(order_[i], 1) - a).cross(corner(order_[i], 2) - a);
      const double weight = twice.norm() + std::numeric_limits<double>::min();
      group.area += 0.5 * twice;
      group.centre += weight * centre_of(order_[i]);
      weights += weight;
      centres.extend(centre_of(order_[i]));
    }
    group.centre /= weights;
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        group.radius = std::max(group.radius, (corner(order_[i], k) - group.centre).norm());
      }
    }
    if (end - begin > kLeaf) {
      Eigen::Index axis = 0;
      centres.sizes().maxCoeff(&axis);
      const std::size_t middle = begin + (end - begin) / 2;
      std::nth_element(order_.begin() + static_cast<std::ptrdiff_t>(begin),
                       order_.begin() + static_cast<std::ptrdiff_t>(middle),
                       order_.begin() + static_cast<std::ptrdiff_t>(end),
                       [&](std::size_t a, std::size_t b) {
                         return std::pair(centre_of(a)[axis], a) < std::pair(centre_of(b)[axis], b);
                       });
      build(begin, middle);
      group.right = build(middle, end);
    }
    group_[index] = group;
    return index;
  }

  double angle(std::size_t index, const Vector3d& x) const {
    const Group& group = group_[index];
    const Vector3d away = group.centre - x;
    const double distance = away.norm();
    if (distance > kFar * group.radius) {
      return group.area.dot(away) / (distance * distance * distance);
    }
    if (group.right > 0) return angle(index + 1, x) + angle(group.right, x);
    double sum = 0;
    for (std::size_t i = group.begin; i < group.end; ++i) sum += solid_angle(order_[i], x);
    return sum;
  }

  // Van Oosterom & Strackee 1983.
  double solid_angle(std::size_t triangle, const Vector3d& x) const {
    const Vector3d a = corner(triangle, 0) - x;
    const Vector3d b = corner(triangle, 1) - x;
    const Vector3d c = corner(triangle, 2) - x;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    return 2 * std::atan2(a.dot(b.cross(c)),
                          la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }

  const Surface& surface_;
  std::vector<std::size_t> order_;
  std::vector<Group> group_;
};

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
  std::ranges::copy(distance, values->GetPointer(0));
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
  Surface surface = from_vtk(*edges->GetOutput());
  if (enclosed_volume(surface) < 0) {
    for (auto& t : surface.triangles) std::swap(t[1], t[2]);
  }
  return surface;
}

// The triangles of each shell.
std::vector<Surface> shells_of(const Surface& surface) {
  std::vector<int> of(surface.points.size());
  std::iota(of.begin(), of.end(), 0);
  const auto root = [&](int point) {
    while (of[at(point)] != point) point = of[at(point)] = of[at(of[at(point)])];
    return point;
  };
  for (const auto& t : surface.triangles) {
    for (const int corner : {t[1], t[2]}) {
      const int a = root(t[0]);
      const int b = root(corner);
      of[at(std::max(a, b))] = std::min(a, b);
    }
  }
  std::map<int, Surface> shells;
  for (const auto& t : surface.triangles) {
    Surface& shell = shells[root(t[0])];
    shell.points = {};
    shell.triangles.push_back(t);
  }
  std::vector<Surface> all;
  for (auto& [_, shell] : shells) {
    shell.points = surface.points;
    all.push_back(merge_points(shell));
  }
  return all;
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

// By the triangles' centres.
double share_left(const Surface& old, Distance& from, double far) {
  double all = 0;
  double left = 0;
  for (const auto& t : old.triangles) {
    const double area = area_of(old, t);
    all += area;
    const Vector3d centre =
        (old.points[at(t[0])] + old.points[at(t[1])] + old.points[at(t[2])]) / 3;
    if (from.of(centre) > far) left += area;
  }
  return all > 0 ? left / all : 0;
}

void require_finite(const Surface& raw) {
  if (raw.triangles.empty()) refuse("the surface holds no triangles");
  for (const Vector3d& x : raw.points) {
    if (!x.allFinite()) refuse("the surface has a coordinate that is not a finite number");
  }
}

}  // namespace

RepairedSurface repair_surface(const Surface& raw, double detail, const Progress& progress) {
  require_finite(raw);
  const Edges edges = edges_of(raw);
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
  repaired.left_share = share_left(wound, from_new, 2 * grid.spacing);
  return repaired;
}

}  // namespace hvp::mesh
