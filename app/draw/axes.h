#pragma once

#include "app/draw/canvas.h"

namespace hvp::draw {

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

}  // namespace hvp::draw
