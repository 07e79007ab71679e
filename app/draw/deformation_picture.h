#pragma once

#include "app/draw/deformation_step.h"

namespace hvp::draw {

class PictureWindow;

// The scene with title, colour scale, legend and scale of length. `step` is needed until the
// window has rendered.
void draw_deformation(PictureWindow& window, const DeformationStep& step);

}  // namespace hvp::draw
