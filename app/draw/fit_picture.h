#pragma once

#include <string>

#include "app/draw/fit_series.h"

namespace hvp::draw {

class PictureWindow;

struct FitLabels {
  std::string x;     // "time (s)"
  std::string y;     // "force"
  std::string unit;  // of observed, modelled and residual: "N"
};

// A log, the model over it, and below them on an axis of its own what is left over. The arguments
// are needed until the window has rendered.
void draw_fit(PictureWindow& window, const FitSeries& series, const FitLabels& labels);

}  // namespace hvp::draw
