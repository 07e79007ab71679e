#pragma once

#include "app/draw/run_files.h"

namespace hvp::draw {

class Canvas;

// Where the worst frame's time went: a bar for each part and phase, the largest first, in the
// lower left of the picture.
void draw_attribution(Canvas& canvas, const Deadline& deadline);

}  // namespace hvp::draw
