#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "models/collision/contact.h"
#include "models/fit/tissue_problem.h"

namespace hvp::fit {

// The frames of a run (frames.csv), of its first probe.
struct TouchedFrames {
  std::vector<double> time;            // s: when the frame was born
  std::vector<Eigen::Vector3d> tip;    // m: x_m, y_m, z_m
  std::vector<int> contact_node;       // node of the mesh; −1: no contact
  std::vector<Eigen::Vector3d> force;  // N, on the probe: fx_N, fy_N, fz_N
};

struct FrameTouches {
  std::vector<TissueLog> logs;
  std::vector<std::string> warnings;
};

// The touches of a run whose tip moves along `direction`, which points into the body. The node's
// motion is that of collision::HandOver: contact is found late, and for `hand_over_s`
// (contact.hand_over) the node moves from where it was to its place by the tip. That place is found
// again from the first frame of the touch (collision::ContactSearch). The node is taken to stay in
// place sideways, as contact.grip = "offset" prescribes where the tip moves along the surface's
// normal.
//
// A body with inertia depends on its past, so that only its first touch is taken. A static body
// gives every touch; where contact slides from node to node, the frames before the force of the
// earlier node has faded are left out. For a hand-over of zero, TissueBody::velocity_of_way is
// false.
//
// Throws InputError: columns of unequal length, a node that is not in the mesh, no touch of enough
// frames.
FrameTouches touches_of_frames(const TissueBody& body, const TouchedFrames& frames,
                               const Eigen::Vector3d& direction,
                               const collision::ContactSettings& contact);

}  // namespace hvp::fit
