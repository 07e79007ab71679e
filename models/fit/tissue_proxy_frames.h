#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "models/fit/tissue_frames.h"
#include "models/fit/tissue_problem.h"
#include "models/fit/tissue_proxy.h"

namespace hvp::fit {

// The frames of a run whose contact is a proxy.
struct GlidingFrames : TouchedFrames {
  std::vector<Eigen::Vector3d> foot;  // m: foot_x_m, foot_y_m, foot_z_m
  std::vector<bool> slides;           // slides
};

// The probe of such a run.
struct ProxyProbe {
  double radius_m = 0;    // probe.radius
  double friction = 0.3;  // contact.friction
};

// The touches of such a run. The proxy is where the run had it, so that it may glide, and the force
// along `direction`, which points into the body, is compared. The first touch of a body with
// inertia alone is taken, as the body still moves in a later one; a static body gives every touch.
//
// Throws InputError: columns of unequal length, a foot that is not on the mesh's surface, no touch
// of enough frames.
FrameTouches touches_of_frames(const TissueBody& body, const GlidingFrames& frames,
                               const Eigen::Vector3d& direction, const ProxyProbe& probe);

// The path of a probe that is pressed along `direction` by these displacements, m, onto a node of
// the surface, where it sticks. Throws InputError for a node that is not on the surface, or
// anchored, and for a direction without a length.
ProxyPath press_at_node(const TissueBody& body, int node, const Eigen::Vector3d& direction,
                        std::span<const double> displacement, double radius_m);

}  // namespace hvp::fit
