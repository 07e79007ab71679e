#include "app/draw/axes.h"

#include <cstddef>

#include "app/draw/axis_ticks.h"

namespace hvp::draw {

using Point = Canvas::Point;

void draw_y_axis(Canvas& canvas, const Axes& axes, int wanted_ticks) {
  const Ticks y = round_ticks(axes.data_low.y(), axes.data_high.y(), wanted_ticks);
  for (std::size_t i = 0; i < y.values.size(); ++i) {
    const Point p = axes.at(axes.data_low.x(), y.values[i]);
    canvas.line(p, {axes.high.x(), p.y()}, style::kGrid, 1.0);
    canvas.text(p - Point(10.0, 0.0), y.labels[i],
                {.size = 18, .colour = style::kSoftInk, .horizontal = Align::high});
  }
  canvas.line(axes.low, {axes.high.x(), axes.low.y()}, style::kSoftInk, 1.4);
  canvas.line(axes.low, {axes.low.x(), axes.high.y()}, style::kSoftInk, 1.4);
}

void draw_x_axis(Canvas& canvas, const Axes& axes, const Ticks& ticks, const std::string& label) {
  for (std::size_t i = 0; i < ticks.values.size(); ++i) {
    const Point p = axes.at(ticks.values[i], axes.data_low.y());
    canvas.line(p, p - Point(0.0, 6.0), style::kSoftInk, 1.2);
    canvas.text(p - Point(0.0, 11.0), ticks.labels[i],
                {.size = 18,
                 .colour = style::kSoftInk,
                 .horizontal = Align::centre,
                 .vertical = Align::high});
  }
  canvas.text({0.5 * (axes.low.x() + axes.high.x()), axes.low.y() - 52.0}, label,
              {.size = 19, .horizontal = Align::centre});
}

Point Legend::entry(const std::string& words) {
  const TextStyle text = {.size = 18, .horizontal = Align::high};
  canvas_.text(next_, words, text);
  next_.x() -= canvas_.text_width(words, text) + 18.0;
  const Point sign = next_;
  next_.x() -= 30.0;
  return sign;
}

}  // namespace hvp::draw
