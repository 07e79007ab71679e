#pragma once

#include "app/draw/loop_series.h"
#include "app/draw/run_files.h"

namespace hvp::draw {

class PictureWindow;

// Over time, one above the other: where the hand wants the tip and where it is, along the axis that
// moves most; the forces on the tip along it; what energy is stored and what the loop has absorbed,
// with the stretches marked in which it has fed energy in. Of the first probe, with a thin line for
// each further one. The arguments are needed until the window has rendered.
void draw_loop(PictureWindow& window, const LoopSeries& loop, const Caption& caption);

}  // namespace hvp::draw
