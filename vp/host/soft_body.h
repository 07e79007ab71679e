#pragma once

#include "models/collision/contact_search.h"
#include "models/fem/body.h"
#include "models/host/frame_computation.h"
#include "models/host/gliding_contact.h"

namespace hvp::vp {

// The body that the user touches. All members have to outlive the platform.
struct SoftBody {
  const fem::Body& body;
  host::FrameComputation& computation;
  collision::ContactSearch& contacts;
  // What contact by a proxy needs; null where nodes follow the tips.
  const host::GlideTables* glide = nullptr;
};

}  // namespace hvp::vp
