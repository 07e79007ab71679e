#pragma once

#include <optional>
#include <vector>

#include "app/scene/scene.h"
#include "models/host/rounding_estimate.h"

namespace hvp::app {

// A few contacts along the probe's way, each as deep as the probe goes there, and the loads alone
// where there are some. Of a probe that never reaches the body: a touch of 1 mm where it is
// nearest.
std::vector<host::UnitContact> unit_contacts(const Scene& scene);

// What the matrix' words do to those contacts. None where no words are computed, or a system is so
// large that its factors take longer than a run's set-up should.
std::optional<host::RoundingEstimate> estimate_rounding(const Scene& scene);
// The same of other words for the scene's body.
std::optional<host::RoundingEstimate> estimate_rounding(const Scene& scene,
                                                        const host::FrameComputation& computation);

}  // namespace hvp::app
