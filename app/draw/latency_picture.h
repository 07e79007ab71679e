#pragma once

#include <vector>

#include "app/draw/run_files.h"

namespace hvp::draw {

class PictureWindow;

// Above, the latency of every frame against the budget, contact shaded and the worst frame
// marked; below, where the worst frame's time went and how often which latency occurred. The
// arguments are needed until the window has rendered.
void draw_latency(PictureWindow& window, const std::vector<FrameRow>& frames,
                  const Deadline& deadline, const Caption& caption);

}  // namespace hvp::draw
