#pragma once

#include <vector>

#include "models/collision/contact.h"
#include "vp/host/mailbox.h"

namespace hvp::vp {

// What the servo process leaves for the collision process (thesis Fig. 6.1).
struct SceneState {
  // A probe each, with the contact that the displacement was computed with. Its force is the mean
  // over the frames since contacts were last reported on: a single frame's force rings at half the
  // servo rate where the time integration does not damp, and its sign says nothing.
  std::vector<collision::Touch> touches;
  std::vector<double> displacement;  // over all mesh nodes
  bool has_force = true;             // false: nobody computes it
};

// And what comes back: the probes' contacts, as old as the pass that found them.
struct ContactReport {
  std::vector<collision::Contact> contacts;
  Picoseconds pass_began = 0;
};

struct Exchange {
  Mailbox<SceneState> scene;
  Mailbox<ContactReport> contact;
};

}  // namespace hvp::vp
