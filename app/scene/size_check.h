#pragma once

#include "app/scene/scenario.h"
#include "app/scene/scene.h"
#include "models/accel/device.h"

namespace hvp::app {

// Refuses, before anything of that size is made, a mesh that is too large by far: for the device or
// its registers by a factor of two, as told by a coarse mesh of the same body and anchors, or for
// the host's memory where it factorises the matrix. What is nearer to a limit is decided by the
// mesh itself. Throws InputError with the full key.
void require_plausible_size(const Scenario& s, const accel::Device& device,
                            const Progress& progress);

}  // namespace hvp::app
