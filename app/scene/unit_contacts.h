#pragma once

#include <optional>
#include <vector>

#include "app/scene/scene.h"
#include "models/host/rounding_estimate.h"

namespace hvp::app {

// Samples a few contacts along the probe's way, each as deep as the probe goes there, and adds the
// loads alone if there are any. If the probe never reaches the body, the contact is 1 mm deep at
// the nearest place.
std::vector<host::UnitContact> unit_contacts(const Scene& scene);

// Estimates the error that the rounding of the matrix causes for those contacts. Returns nothing if
// no words are computed, or if factorising the system would take too long for a run's set-up.
std::optional<host::RoundingEstimate> estimate_rounding(const Scene& scene);
// The same estimate for other words of the scene's body.
std::optional<host::RoundingEstimate> estimate_rounding(const Scene& scene,
                                                        const host::FrameComputation& computation);

}  // namespace hvp::app
