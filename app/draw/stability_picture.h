#pragma once

#include "app/draw/stability_map.h"

namespace hvp::draw {

class PictureWindow;

// Stiffness over damping: up to where the platform's runs are stable, filled below, the same by
// the linear loop's eigenvalues, and the bound of passivity; a negative one lies at the foot, as no
// wall is passive there. The map is needed until the window has rendered.
void draw_stability_map(PictureWindow& window, const StabilityMap& map);

}  // namespace hvp::draw
