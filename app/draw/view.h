#pragma once

#include <Eigen/Core>
#include <span>

#include "app/draw/deformation_step.h"

namespace hvp::draw {

// A parallel projection: lengths in the picture are true along `right` and `up`.
struct View {
  Eigen::Vector3d towards_viewer;  // unit vectors, a right-handed frame with right × up
  Eigen::Vector3d right;
  Eigen::Vector3d up;
};

// Where the dent is seen in profile and the probe is not hidden: up points away from the anchors
// (+z without a clear answer), the viewer looks across the displacement under the probe, a little
// from above and from the pressed side, or more so until the probe shows.
View choose_view(const DeformationStep& step);

// The rectangle that points cover in the picture plane.
struct Extent {
  Eigen::Vector2d low;
  Eigen::Vector2d high;
  Eigen::Vector2d centre() const { return 0.5 * (low + high); }
  Eigen::Vector2d size() const { return high - low; }
};
Extent extent_in(const View& view, std::span<const Eigen::Vector3d> points);

}  // namespace hvp::draw
