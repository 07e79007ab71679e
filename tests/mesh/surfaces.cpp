#include "tests/mesh/surfaces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "models/config/input_error.h"

namespace hvp::mesh::testing {

Surface unit_cube() {
  Surface cube;
  for (const int z : {0, 1}) {
    for (const int y : {0, 1}) {
      for (const int x : {0, 1}) cube.points.emplace_back(x, y, z);
    }
  }
  cube.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return cube;
}

Surface moved(Surface surface, const Eigen::Vector3d& by) {
  for (auto& x : surface.points) x += by;
  return surface;
}

Surface turned_inside_out(Surface surface) {
  for (auto& t : surface.triangles) std::swap(t[1], t[2]);
  return surface;
}

Surface together(const Surface& a, const Surface& b) {
  Surface both = a;
  const int offset = static_cast<int>(a.points.size());
  both.points.insert(both.points.end(), b.points.begin(), b.points.end());
  for (const auto& t : b.triangles) {
    both.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  }
  return both;
}

int euler_characteristic(const std::vector<std::array<int, 3>>& triangles) {
  std::set<int> points;
  std::set<std::pair<int, int>> edges;
  for (const auto& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      points.insert(t[k]);
      edges.insert(std::minmax(t[k], t[(k + 1) % 3]));
    }
  }
  return static_cast<int>(points.size()) - static_cast<int>(edges.size()) +
         static_cast<int>(triangles.size());
}

double volume_from_boundary(const TetMesh& mesh) {
  double volume = 0.0;
  for (const auto& t : mesh.boundary) {
    const Eigen::Vector3d& a = mesh.nodes[static_cast<std::size_t>(t[0])];
    const Eigen::Vector3d& b = mesh.nodes[static_cast<std::size_t>(t[1])];
    const Eigen::Vector3d& c = mesh.nodes[static_cast<std::size_t>(t[2])];
    const Eigen::Vector3d area = 0.5 * (b - a).cross(c - a);
    volume += area.dot((a + b + c) / 3.0) / 3.0;
  }
  return volume;
}

std::string refusal(const std::string& key, const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), key);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return {};
}

}  // namespace hvp::mesh::testing
