#pragma once

#include <string>

#include "app/draw/canvas.h"

namespace hvp::draw {

struct Ticks;

// Data coordinates in a rectangle of the picture.
struct Axes {
  Canvas::Point low;
  Canvas::Point high;
  Canvas::Point data_low;
  Canvas::Point data_high;

  Canvas::Point at(double x, double y) const {
    const Canvas::Point share =
        (Canvas::Point(x, y) - data_low).cwiseQuotient(data_high - data_low);
    return low + share.cwiseProduct(high - low);
  }
};

// Both axes' lines, and about so many ticks up the left side with lines across the plot.
void draw_y_axis(Canvas& canvas, const Axes& axes, int wanted_ticks);

// Ticks below the plot, and what they count.
void draw_x_axis(Canvas& canvas, const Axes& axes, const Ticks& ticks, const std::string& label);

// What the marks of a plot mean, in a line of text that grows to the left.
class Legend {
 public:
  Legend(Canvas& canvas, const Canvas::Point& right_end) : canvas_(canvas), next_(right_end) {}

  // Writes the words and returns the middle of the 24 pixels before them, where the mark goes.
  Canvas::Point entry(const std::string& words);

 private:
  Canvas& canvas_;
  Canvas::Point next_;  // the right end of the next entry
};

}  // namespace hvp::draw
