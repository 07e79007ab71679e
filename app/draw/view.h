#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "app/draw/deformation_step.h"

// The geometry of a picture of the body: its surface, and the direction from which it is seen.

namespace hvp::draw {

// The faces that belong to one tetrahedron alone, in ascending order of their sorted nodes. Their
// normals point outwards where det J > 0.
std::vector<std::array<int, 3>> outer_faces(std::span<const std::array<int, 4>> tetrahedra);

// An edge and the two triangles beside it; the second is -1 where there is only one.
struct Edge {
  std::array<int, 2> nodes;
  std::array<int, 2> faces;
};

// All edges of the triangles, each once, in ascending order of their nodes. An edge with more than
// two triangles keeps the first two.
std::vector<Edge> edges_of(std::span<const std::array<int, 3>> triangles);

// The outline: the edges between a triangle that faces the viewer and one that does not.
// `towards_viewer` points from the body to the viewer.
std::vector<std::array<int, 2>> outline(std::span<const Eigen::Vector3d> points,
                                        std::span<const std::array<int, 3>> triangles,
                                        std::span<const Edge> edges,
                                        const Eigen::Vector3d& towards_viewer);

// True if a triangle lies between `from` and a viewer far away in direction `towards_viewer`.
bool hidden(std::span<const Eigen::Vector3d> points, std::span<const std::array<int, 3>> triangles,
            const Eigen::Vector3d& from, const Eigen::Vector3d& towards_viewer);

// A parallel projection: lengths in the picture are true along `right` and `up`.
struct View {
  Eigen::Vector3d towards_viewer;  // unit vectors, a right-handed frame with right × up
  Eigen::Vector3d right;
  Eigen::Vector3d up;
};

// Chooses a view that shows the dent in profile and does not hide the probe: up points away from
// the anchors (+z without a clear answer), and the viewer looks across the displacement under the
// probe, a little from above and from the pressed side, or more so until the probe is visible.
View choose_view(const DeformationStep& step);

// A rectangle in the picture plane.
struct Extent {
  Eigen::Vector2d low;
  Eigen::Vector2d high;
  Eigen::Vector2d centre() const { return 0.5 * (low + high); }
  Eigen::Vector2d size() const { return high - low; }
};
// The smallest rectangle around the points.
Extent extent_in(const View& view, std::span<const Eigen::Vector3d> points);

}  // namespace hvp::draw
