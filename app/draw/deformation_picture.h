#pragma once

#include "app/draw/deformation_step.h"
#include "app/draw/run_files.h"

namespace hvp::draw {

class PictureWindow;

// The scene with caption, colour scale, legend and scale of length. Both arguments are needed until
// the window has rendered.
void draw_deformation(PictureWindow& window, const DeformationStep& step, const Caption& caption);

}  // namespace hvp::draw
