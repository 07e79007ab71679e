#pragma once

#include <vector>

#include "app/draw/run_files.h"

namespace hvp::draw {

class Canvas;

// How often which latency occurred, against the budget and with the median and the 99th
// percentile, in the lower right of the picture. The counts' scale is logarithmic: one late frame
// among thousands is to be seen.
void draw_histogram(Canvas& canvas, const std::vector<FrameRow>& frames, const Deadline& deadline);

}  // namespace hvp::draw
