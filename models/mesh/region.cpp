#include "models/mesh/region.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "models/config/input_error.h"

namespace hvp::mesh {

namespace {

// No part of any body is farther away, and no square leaves double precision.
constexpr config::Range kPosition = config::between(-1e9, 1e9);

using config::Dimension;
using Eigen::Vector3d;

// A node may lie outside by this fraction of the mesh's diagonal: far above rounding, far below
// any element.
constexpr double kTolerance = 1e-9;

double diagonal(const TetMesh& mesh) {
  return mesh.nodes.empty() ? 0.0 : box_around(mesh.nodes).diagonal().norm();
}

double dot(const Vector3d& a, const Vector3d& b) {
  return a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
}

// The same direction with components of about one, by a power of two: exact, and no product with a
// coordinate leaves double precision.
Vector3d moderate(const Vector3d& direction) {
  int exponent = 0;
  std::frexp(direction.cwiseAbs().maxCoeff(), &exponent);
  return direction.unaryExpr([exponent](double x) { return std::ldexp(x, -exponent); });
}

std::vector<int> lowest_nodes(const Region& region, const TetMesh& mesh) {
  const std::size_t n = mesh.nodes.size();
  std::vector<double> height(n);
  const Vector3d up = moderate(region.direction);
  for (std::size_t i = 0; i < n; ++i) height[i] = dot(mesh.nodes[i], up);
  std::vector<int> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return height[static_cast<std::size_t>(a)] < height[static_cast<std::size_t>(b)];
  });
  auto count = static_cast<std::size_t>(std::llround(region.fraction * static_cast<double>(n)));
  if (region.fraction > 0.0) count = std::max<std::size_t>(count, 1);
  order.resize(std::min(count, n));
  std::sort(order.begin(), order.end());
  return order;
}

bool contains(const Region& region, const Vector3d& x, double tolerance) {
  switch (region.kind) {
    case Region::Kind::half_space: {
      const Vector3d normal = moderate(region.normal);
      return dot(x - region.point, normal) <= tolerance * normal.norm();
    }
    case Region::Kind::box:
      return (x.array() >= region.low_corner.array() - tolerance).all() &&
             (x.array() <= region.high_corner.array() + tolerance).all();
    case Region::Kind::sphere:
      return (x - region.centre).norm() <= region.radius + tolerance;
    case Region::Kind::all:
    case Region::Kind::lowest_fraction:
      break;
  }
  return true;
}

}  // namespace

void Region::declare(config::Visitor& v) {
  const auto of_kind = v.variant(
      "kind", kind,
      {{"lowest-fraction", Kind::lowest_fraction},
       {"half-space", Kind::half_space},
       {"box", Kind::box},
       {"sphere", Kind::sphere},
       {"all", Kind::all}},
      {.help = "how the nodes are chosen", .source = "the scene of the default fraction"});
  of_kind.only({Kind::lowest_fraction}, [&] {
    v.quantity("fraction", fraction, Dimension::dimensionless, config::between(0.0, 1.0),
               {.help = "the part of all nodes, those lowest along direction",
                .source = "lowest 15 %: the scene the thesis' figures are checked with"});
    v.vector("direction", direction, Dimension::dimensionless, {},
             {.help = "which way is up; any length but zero", .source = "z points up"});
  });
  of_kind.only({Kind::half_space}, [&] { declare_half_space(v); });
  of_kind.only({Kind::box}, [&] { declare_box(v); });
  of_kind.only({Kind::sphere}, [&] { declare_sphere(v); });
}

void Region::declare_half_space(config::Visitor& v) {
  v.vector("point", point, Dimension::length, kPosition,
           {.help = "a point of its plane", .source = "the body's origin"});
  v.vector("normal", normal, Dimension::dimensionless, {},
           {.help = "its plane's normal, which points out of the region; any length but zero",
            .source = "z points up: the region is what lies below"});
}

void Region::declare_box(config::Visitor& v) {
  v.vector("low_corner", low_corner, Dimension::length, kPosition,
           {.help = "the corner with the smallest coordinates", .source = "the body's origin"});
  v.vector("high_corner", high_corner, Dimension::length, kPosition,
           {.help = "the corner with the largest coordinates", .source = "the body's origin"});
}

void Region::declare_sphere(config::Visitor& v) {
  v.vector("centre", centre, Dimension::length, kPosition,
           {.help = "its centre", .source = "the body's origin"});
  v.quantity("radius", radius, Dimension::length, {0.0, 1e9, true},
             {.help = "its radius", .required = true});
}

void Region::check() const {
  if (kind == Kind::lowest_fraction && direction.isZero(0.0)) {
    throw InputError("direction", "has length zero; expected a direction such as [0, 0, 1]");
  }
  if (kind == Kind::half_space && normal.isZero(0.0)) {
    throw InputError("normal", "has length zero; expected a direction such as [0, 0, 1]");
  }
  if (kind == Kind::box && !(low_corner.array() <= high_corner.array()).all()) {
    throw InputError("high_corner",
                     "is below low_corner in at least one coordinate: expected none below");
  }
  if (kind == Kind::box && low_corner == high_corner) {
    throw InputError("high_corner", "equals low_corner; expected two different corners");
  }
  if (kind == Kind::sphere && radius <= 0.0) {
    throw InputError("radius", "is 0 m; expected a radius above 0");
  }
}

std::vector<int> select_nodes(const Region& region, const TetMesh& mesh) {
  if (region.kind == Region::Kind::lowest_fraction) return lowest_nodes(region, mesh);
  const double tolerance = kTolerance * diagonal(mesh);
  std::vector<int> selected;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (contains(region, mesh.nodes[i], tolerance)) selected.push_back(static_cast<int>(i));
  }
  return selected;
}

std::vector<int> select_boundary(const Region& region, const TetMesh& mesh) {
  std::vector<char> inside(mesh.nodes.size(), 0);
  for (const int node : select_nodes(region, mesh)) inside[static_cast<std::size_t>(node)] = 1;
  std::vector<int> selected;
  for (std::size_t i = 0; i < mesh.boundary.size(); ++i) {
    const auto& t = mesh.boundary[i];
    if (std::all_of(t.begin(), t.end(),
                    [&](int n) { return inside[static_cast<std::size_t>(n)] != 0; })) {
      selected.push_back(static_cast<int>(i));
    }
  }
  return selected;
}

}  // namespace hvp::mesh
