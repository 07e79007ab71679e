#pragma once

#include <optional>
#include <vector>

#include "app/scene/scene.h"
#include "models/host/rounding_estimate.h"

namespace hvp::app {

// Samples a few contacts along each probe's way, each as deep as the probe goes there, and adds the
// loads alone if there are any. If a probe never reaches the body, its contact is 1 mm deep at the
// nearest place.
std::vector<host::UnitContact> unit_contacts(const Scene& scene);

// The stiffness of the body at its contact, N/m: force over depth of the stiffest of those
// contacts, at rest and with the true matrix. Returns nothing if no contact is deep.
std::optional<double> contact_stiffness(const Scene& scene);

// True if the true matrix can be factorised within a run's set-up.
bool quick_to_factorise(const Scene& scene);

// Estimates the error that the rounding of the matrix causes for those contacts. Returns nothing if
// no words are computed, or if factorising the system would take too long for a run's set-up.
std::optional<host::RoundingEstimate> estimate_rounding(const Scene& scene);
// The same estimate for other words of the scene's body.
std::optional<host::RoundingEstimate> estimate_rounding(const Scene& scene,
                                                        const host::FrameComputation& computation);

}  // namespace hvp::app
