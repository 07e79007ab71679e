#pragma once

#include <string>
#include <vector>

#include "app/draw/deformation_step.h"
#include "app/draw/run_files.h"
#include "app/draw/series_files.h"

// The pictures. Each function keeps references to its arguments, which must live until the window
// has rendered.

namespace hvp::draw {

class PictureWindow;

// The deformed body with caption, colour scale, legend and scale of length.
void draw_deformation(PictureWindow& window, const DeformationStep& step, const Caption& caption);

// Above, the latency of every frame and the budget, with contact shaded and the worst frame marked;
// below, the attribution of the worst frame's time and the histogram of latencies.
void draw_latency(PictureWindow& window, const std::vector<FrameRow>& frames,
                  const Deadline& deadline, const Caption& caption);

// Three plots over time, one above the other: the tip's intended and actual position along the axis
// that moves most; the forces on the tip along it; the stored energy and the energy that the loop
// has absorbed, with a mark where it has fed energy in. Further probes have thin lines.
void draw_loop(PictureWindow& window, const LoopSeries& loop, const Caption& caption);

struct FitLabels {
  std::string x;     // "time (s)"
  std::string y;     // "force"
  std::string unit;  // of observed, modelled and residual: "N"
};

// A log and the model over it; below them, on an axis of its own, the residual.
void draw_fit(PictureWindow& window, const FitSeries& series, const FitLabels& labels);

// The largest stable stiffness over damping: by the platform's runs, filled below, and by the
// linear loop's eigenvalues; and the bound of passivity, which is drawn at the foot where it is
// negative and no wall is passive.
void draw_stability_map(PictureWindow& window, const StabilityMap& map);

}  // namespace hvp::draw
