#pragma once

#include <vector>

#include "app/draw/run_files.h"

namespace hvp::draw {

class Canvas;

// Draws the attribution of the worst frame's time: a bar for each part and phase, the largest
// first, in the lower left of the picture.
void draw_attribution(Canvas& canvas, const Deadline& deadline);

// Draws the histogram of the latencies with the budget, the median and the 99th percentile, in the
// lower right of the picture. The counts' scale is logarithmic, so that one late frame among
// thousands is visible.
void draw_histogram(Canvas& canvas, const std::vector<FrameRow>& frames, const Deadline& deadline);

}  // namespace hvp::draw
