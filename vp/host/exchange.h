#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/collision/contact_search.h"
#include "vp/host/mailbox.h"

namespace hvp::vp {

// What the servo process leaves for the collision process (thesis Fig. 6.1).
struct SceneState {
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();
  std::vector<double> displacement;  // over all mesh nodes
  collision::Contact contact;        // the one that the displacement was computed with
  // Mean over the frames since the contact was last reported on: a single frame's force rings
  // at half the servo rate where the time integration does not damp, and its sign says nothing.
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  bool has_force = true;  // false: nobody computes it
};

// And what comes back: the contact node, as old as the pass that found it.
struct ContactReport {
  collision::Contact contact;
  Picoseconds pass_began = 0;
};

struct Exchange {
  Mailbox<SceneState> scene;
  Mailbox<ContactReport> contact;
};

}  // namespace hvp::vp
