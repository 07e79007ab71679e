#pragma once

#include "vp/frame/frame.h"

namespace hvp::vp {

// When the servo loop began: set-up (loading K) lies before it. The probe's trajectory and every
// result count time from here.
struct Session {
  Picoseconds begin = 0;
  bool begun = false;
};

}  // namespace hvp::vp
