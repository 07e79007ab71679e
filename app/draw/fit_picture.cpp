#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "app/draw/canvas.h"
#include "app/draw/picture_window.h"
#include "app/draw/pictures.h"
#include "app/draw/plot_data.h"
#include "app/draw/run_files.h"

namespace hvp::draw {
namespace {

using Point = Canvas::Point;

constexpr double kFitLeft = 130.0;
constexpr double kFitRight = 1365.0;
constexpr Colour kObserved = {150, 160, 170};
constexpr Colour kModelled = {213, 94, 0};
constexpr Colour kResidual = {38, 102, 150};

struct FitPanel {
  double low = 0.0;
  double high = 0.0;
  Unit unit;
  Range range;
};

// A share has no unit.
Unit unit_of(double largest, const std::string& symbol, double preferred) {
  if (symbol.empty()) return {1.0, ""};
  return unit_for(largest, symbol, preferred);
}

std::string with(const std::string& label, const Unit& unit) {
  return unit.name.empty() ? label : fmt::format("{} ({})", label, unit.name);
}

FitPanel panel_of(double low, double high, Range range, const std::string& symbol) {
  const double largest = std::max(std::abs(range.least), std::abs(range.largest));
  const double slack = range.size() > 0 ? 0.06 * range.size() : std::max(0.1 * largest, 1e-12);
  return {low,
          high,
          unit_of(largest, symbol, symbol == "N" ? 1.0 : 1e-3),
          {range.least - slack, range.largest + slack}};
}

Axes axes_of(const FitPanel& panel, const Range& x) {
  return {{kFitLeft, panel.low},
          {kFitRight, panel.high},
          {x.least, panel.range.least / panel.unit.size},
          {x.largest, panel.range.largest / panel.unit.size}};
}

void draw_values(Canvas& canvas, const Axes& axes, const FitSeries& series,
                 const std::vector<double>& values, const Unit& unit, Colour colour, double width) {
  constexpr int kColumns = static_cast<int>(kFitRight - kFitLeft) * kSupersampling;
  for (auto& stroke : strokes(series.x, values, axes.data_low.x(), axes.data_high.x(), kColumns)) {
    for (Point& p : stroke) p = axes.at(p.x(), p.y() / unit.size);
    canvas.polyline(stroke, colour, width);
  }
}

void draw_frame(Canvas& canvas, const Axes& axes, const Ticks& ticks, const std::string& label,
                int wanted) {
  for (const double tick : ticks.values) {
    const double x = axes.at(tick, 0.0).x();
    canvas.line({x, axes.low.y()}, {x, axes.high.y()}, style::kGrid, 1.0);
  }
  draw_y_axis(canvas, axes, wanted);
  canvas.text({28.0, 0.5 * (axes.low.y() + axes.high.y())}, label,
              {.size = 19, .horizontal = Align::centre, .angle_deg = 90.0});
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    sum += v * v;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0.0;
}

std::string figures(const FitSeries& series, const FitLabels& labels) {
  const double left = rms(series.residual);
  const Unit unit = unit_of(left, labels.unit, 1.0);
  const auto samples = std::count_if(series.residual.begin(), series.residual.end(),
                                     [](double v) { return std::isfinite(v); });
  return fmt::format("{} samples · {}{} rms left over", samples, four_digits(left / unit.size),
                     unit.name.empty() ? "" : " " + unit.name);
}

void paint(Canvas& canvas, const FitSeries& series, const FitLabels& labels) {
  draw_caption(canvas, {.title = series.title, .verdict = {}, .flags = {}}, "Model and log",
               figures(series, labels));
  Range x = range_of(series.x);
  if (!(x.size() > 0.0)) x.largest = x.least + 1.0;
  const Ticks ticks = round_ticks(x.least, x.largest, 10);

  Range values = range_of(series.observed);
  values.include(range_of(series.modelled));
  const FitPanel above = panel_of(390.0, 862.0, values, labels.unit);
  const Axes top = axes_of(above, x);
  draw_frame(canvas, top, ticks, with(labels.y, above.unit), 8);
  draw_values(canvas, top, series, series.observed, above.unit, kObserved, 5.0);
  draw_values(canvas, top, series, series.modelled, above.unit, kModelled, 2.0);
  Legend legend(canvas, top.high + Point(0.0, 18.0));
  Point p = legend.entry("model");
  canvas.line(p - Point(12.0, 0.0), p + Point(12.0, 0.0), kModelled, 3.0);
  p = legend.entry("log");
  canvas.line(p - Point(12.0, 0.0), p + Point(12.0, 0.0), kObserved, 5.0);

  const FitPanel below = panel_of(110.0, 350.0, range_of(series.residual), labels.unit);
  const Axes foot = axes_of(below, x);
  draw_frame(canvas, foot, ticks, with("left over", below.unit), 5);
  draw_values(canvas, foot, series, series.residual, below.unit, kResidual, 1.5);
  draw_x_axis(canvas, foot, ticks, labels.x);
}

}  // namespace

void draw_fit(PictureWindow& window, const FitSeries& series, const FitLabels& labels) {
  add_page(window, [&](Canvas& canvas) { paint(canvas, series, labels); });
}

}  // namespace hvp::draw
