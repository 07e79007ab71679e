#pragma once

#include <optional>

#include "models/config/declaration.h"

namespace hvp::collision {

// How the probe holds the node that it touches.
enum class Grip {
  offset,  // the node keeps the sideways distance to the tip that it had when contact began
  snap,    // the node is where the tip is, to the letter of thesis §3.7
};

// The effect [contact.fresh]: contact is found anew in every frame, without taking time, in place
// of what the 33 Hz process last found.
struct FreshContact {
  void declare(config::Visitor&) {}
};

// Rules of contact: scenario table [contact]. docs/collision.md gives the reasons.
struct ContactSettings {
  Grip grip = Grip::offset;
  double hysteresis = 0.05;    // fraction by which another node must be nearer to take over
  double release_force = 0.0;  // N, pull along the outward normal above which contact ends
  double patch_radius = 0.0;   // m; 0: a single node
  double hand_over_s = 30e-3;  // 0: the prescribed displacement jumps
  std::optional<FreshContact> fresh = {};

  void declare(config::Visitor& v);
};

}  // namespace hvp::collision
