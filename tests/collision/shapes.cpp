#include "tests/collision/shapes.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <utility>

namespace hvp::collision::test {

using Eigen::Vector3d;
using Eigen::Vector3i;

mesh::TetMesh box(const Vector3d& size, const Vector3i& cells) {
  mesh::TetMesh mesh;
  std::map<std::array<int, 3>, int> number;
  const auto node = [&](const Vector3i& at) {
    const auto [entry, added] =
        number.try_emplace({at.x(), at.y(), at.z()}, static_cast<int>(mesh.nodes.size()));
    if (added) {
      mesh.nodes.emplace_back(size.array() * at.cast<double>().array() /
                              cells.cast<double>().array());
    }
    return entry->second;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    for (const bool high : {false, true}) {
      for (int i = 0; i < cells[u]; ++i) {
        for (int j = 0; j < cells[v]; ++j) {
          const auto corner = [&](int di, int dj) {
            Vector3i at;
            at[axis] = high ? cells[axis] : 0;
            at[u] = i + di;
            at[v] = j + dj;
            return node(at);
          };
          const std::array<int, 4> q = {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
          if (high) {
            mesh.boundary.push_back({q[0], q[1], q[2]});
            mesh.boundary.push_back({q[0], q[2], q[3]});
          } else {
            mesh.boundary.push_back({q[0], q[2], q[1]});
            mesh.boundary.push_back({q[0], q[3], q[2]});
          }
        }
      }
    }
  }
  return mesh;
}

mesh::TetMesh sphere(double radius, int levels) {
  const double g = std::numbers::phi;
  mesh::TetMesh mesh;
  mesh.nodes = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.boundary = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                   {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                   {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                   {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [entry, added] = middles.try_emplace({std::min(a, b), std::max(a, b)},
                                                      static_cast<int>(mesh.nodes.size()));
      if (added) {
        mesh.nodes.push_back(mesh.nodes[static_cast<std::size_t>(a)].normalized() +
                             mesh.nodes[static_cast<std::size_t>(b)].normalized());
      }
      return entry->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& t : mesh.boundary) {
      const int ab = middle(t[0], t[1]);
      const int bc = middle(t[1], t[2]);
      const int ca = middle(t[2], t[0]);
      finer.push_back({t[0], ab, ca});
      finer.push_back({t[1], bc, ab});
      finer.push_back({t[2], ca, bc});
      finer.push_back({ab, bc, ca});
    }
    mesh.boundary = finer;
  }
  for (Vector3d& node : mesh.nodes) node = radius * node.normalized();
  return mesh;
}

mesh::TetMesh spike() {
  mesh::TetMesh mesh;
  mesh.nodes = {{0.0, 0.0, 0.0}, {0.1, 0.0, 0.0}, {0.03, 0.08, 0.0}, {0.6, 0.3, 1.0}};
  mesh.boundary = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return mesh;
}

double winding_number(const mesh::TetMesh& mesh, const Vector3d& p) {
  double solid_angle = 0.0;
  for (const auto& t : mesh.boundary) {
    const Vector3d a = mesh.nodes[static_cast<std::size_t>(t[0])] - p;
    const Vector3d b = mesh.nodes[static_cast<std::size_t>(t[1])] - p;
    const Vector3d c = mesh.nodes[static_cast<std::size_t>(t[2])] - p;
    solid_angle +=
        2.0 * std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                                b.dot(c) * a.norm() + c.dot(a) * b.norm());
  }
  return solid_angle / (4.0 * std::numbers::pi);
}

double Uniform::operator()(double low, double high) {
  state_ += 0x9e3779b97f4a7c15ULL;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  z ^= z >> 31;
  return low + (high - low) * static_cast<double>(z >> 11) * 0x1p-53;
}

Vector3d Uniform::in_cube(double half_side) {
  const double x = (*this)(-half_side, half_side);
  const double y = (*this)(-half_side, half_side);
  const double z = (*this)(-half_side, half_side);
  return {x, y, z};
}

}  // namespace hvp::collision::test
