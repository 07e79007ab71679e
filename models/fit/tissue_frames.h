#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "models/collision/contact_settings.h"
#include "models/fit/tissue_problem.h"

namespace hvp::fit {

// What a run of the platform writes of each frame (frames.csv), of its first probe.
struct TouchedFrames {
  std::vector<double> time;            // s: when the frame was born
  std::vector<Eigen::Vector3d> tip;    // m: x_m, y_m, z_m
  std::vector<int> contact_node;       // of the mesh; −1: no contact
  std::vector<Eigen::Vector3d> force;  // N, on the probe: fx_N, fy_N, fz_N
};

struct FrameTouches {
  std::vector<TissueLog> logs;
  std::vector<std::string> warnings;
};

// The touches of a run whose tip moves along `direction`, which points into the body. The node's
// own way is that of collision::HandOver: contact is found late, and for `hand_over_s`
// (contact.hand_over) the node is on its way from where it was to its place by the tip. That place
// is found again from the first frame of the touch (collision::ContactSearch). Sideways the node is
// taken to stay where it is, as contact.grip = "offset" has it where the tip moves along the
// surface's normal.
//
// A body with inertia remembers: its first touch alone is taken. A static one gives every touch;
// where contact slides from node to node, what comes before the force of the node before has faded
// is left out. For a hand-over of zero, TissueBody::velocity_of_way is false.
//
// Throws InputError: columns of unequal length, a node that is not in the mesh, no touch of enough
// frames.
FrameTouches touches_of_frames(const TissueBody& body, const TouchedFrames& frames,
                               const Eigen::Vector3d& direction,
                               const collision::ContactSettings& contact);

}  // namespace hvp::fit
