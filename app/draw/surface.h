#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

namespace hvp::draw {

// The faces that belong to one tetrahedron alone, turned so that their normals point out of it
// where det J > 0, in ascending order of their sorted nodes.
std::vector<std::array<int, 3>> outer_faces(std::span<const std::array<int, 4>> tetrahedra);

// An edge and the two triangles beside it; the second is -1 where there is only one.
struct Edge {
  std::array<int, 2> nodes;
  std::array<int, 2> faces;
};

// Every edge of the triangles once, in ascending order of its nodes. Of a third and further
// triangle on one edge only the first two are kept.
std::vector<Edge> edges_of(std::span<const std::array<int, 3>> triangles);

// The edges at which the surface turns from towards the viewer to away from him: the outline.
// `towards_viewer` points from the body to the viewer.
std::vector<std::array<int, 2>> outline(std::span<const Eigen::Vector3d> points,
                                        std::span<const std::array<int, 3>> triangles,
                                        std::span<const Edge> edges,
                                        const Eigen::Vector3d& towards_viewer);

// Whether a triangle lies between `from` and a viewer far away in direction `towards_viewer`.
bool hidden(std::span<const Eigen::Vector3d> points, std::span<const std::array<int, 3>> triangles,
            const Eigen::Vector3d& from, const Eigen::Vector3d& towards_viewer);

}  // namespace hvp::draw
