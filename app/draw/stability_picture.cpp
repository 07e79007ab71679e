#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/draw/canvas.h"
#include "app/draw/pictures.h"
#include "app/draw/plot_data.h"

namespace hvp::draw {
namespace {

using Point = Canvas::Point;
using Curve = std::vector<Point>;  // in the picture, from left to right

constexpr Colour kRuns = {38, 102, 150};
constexpr Colour kLinear = {213, 94, 0};
constexpr Colour kPassive = {98, 104, 112};
constexpr Colour kStable = {218, 231, 240};

Axes axes_of(const StabilityMap& map) {
  double stiffest = 0.0;
  for (const auto* values : {&map.runs_N_m, &map.linear_N_m, &map.passive_N_m}) {
    stiffest = std::max(stiffest, *std::max_element(values->begin(), values->end()));
  }
  const double low = map.damping_N_s_m.front();
  const double high = map.damping_N_s_m.back();
  const double margin = high > low ? 0.02 * (high - low) : std::max(0.5 * std::abs(high), 1.0);
  return {{130.0, 110.0},
          {1365.0, 862.0},
          {low - margin, 0.0},
          {high + margin, stiffest > 0.0 ? 1.08 * stiffest : 1.0}};
}

Curve curve_of(const Axes& axes, const StabilityMap& map, const std::vector<double>& stiffness) {
  Curve curve;
  for (std::size_t i = 0; i < stiffness.size(); ++i) {
    curve.push_back(axes.at(map.damping_N_s_m[i], std::max(stiffness[i], 0.0)));
  }
  return curve;
}

void fill_below(Canvas& canvas, const Curve& curve, double foot) {
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const Point& a = curve[i - 1];
    const Point& b = curve[i];
    const std::array<Point, 4> corners = {Point(a.x(), foot), a, b, Point(b.x(), foot)};
    canvas.polygon(corners, kStable);
  }
}

// Points of a curve that are a few pixels apart.
void sample(const Curve& curve, std::vector<Point>& out) {
  constexpr double kStep = 5.0;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    out.push_back(curve[i]);
    if (i + 1 == curve.size()) return;
    const Point step = curve[i + 1] - curve[i];
    const int parts = static_cast<int>(std::ceil(step.norm() / kStep));
    for (int part = 1; part < parts; ++part) {
      out.push_back(curve[i] + static_cast<double>(part) / parts * step);
    }
  }
}

// Half a word's width and height, and the room that it should have around it.
struct Word {
  Point half;
  bool below;  // the runs' curve, or above it
};

// The distance of the word at a place from the nearest of the points; absent where a point of the
// runs' curve is on the wrong side of the word, or no point is above or below it.
std::optional<double> clearance(const Word& word, const Point& at, const std::vector<Point>& runs,
                                const std::vector<Point>& all) {
  bool met = false;
  for (const Point& p : runs) {
    if (std::abs(p.x() - at.x()) > word.half.x()) continue;
    met = true;
    if (word.below != (p.y() > at.y())) return {};
  }
  if (!met) return {};
  double least = 1e9;
  for (const Point& p : all) {
    least = std::min(least, ((p - at).cwiseAbs() - word.half).cwiseMax(0.0).norm());
  }
  return least > 0.0 ? std::optional(least) : std::nullopt;
}

// Writes the word furthest from every curve and from the plot's edges; not at all without room.
void write_word(Canvas& canvas, const Axes& axes, const std::string& words, bool below,
                const std::array<Curve, 3>& curves) {
  const TextStyle text = {
      .size = 30, .colour = below ? kRuns : style::kLate, .horizontal = Align::centre};
  const Word word = {{0.5 * canvas.text_width(words, text) + 4.0, 18.0}, below};
  std::vector<Point> runs;
  sample(curves.front(), runs);
  std::vector<Point> all;
  for (const Curve& curve : curves) sample(curve, all);

  constexpr double kGrid = 15.0;
  double best = 0.0;
  Point place;
  const Point first = axes.low + word.half;
  const Point room_for = axes.high - word.half - first;
  for (int i = 0; i * kGrid <= room_for.x(); ++i) {
    for (int j = 0; j * kGrid <= room_for.y(); ++j) {
      const Point at = first + kGrid * Point(i, j);
      const auto room = clearance(word, at, runs, all);
      if (!room) continue;
      const double edge =
          std::min((at - word.half - axes.low).minCoeff(), (axes.high - word.half - at).minCoeff());
      const double least = std::min(*room, edge);
      if (least <= best) continue;
      best = least;
      place = at;
    }
  }
  if (best > 0.0) canvas.text(place, words, text);
}

void draw_legend(Canvas& canvas) {
  Legend legend(canvas, {1365.0, 886.0});
  const Point across(12.0, 0.0);
  Point p = legend.entry("bound of passivity");
  canvas.dashed_line(p - across, p + across, kPassive, 2.5);
  p = legend.entry("exact eigenvalues");
  canvas.line(p - across, p + across, kLinear, 2.5);
  p = legend.entry("runs of the platform");
  canvas.line(p - across, p + across, kRuns, 2.0);
  canvas.disc(p, 4.5, kRuns);
}

std::string figures(const StabilityMap& map) {
  const auto stiffest = std::max_element(map.runs_N_m.begin(), map.runs_N_m.end());
  const std::size_t rows = map.runs_N_m.size();
  return fmt::format(
      "{} {} · runs stable up to {} N/m, at {} N·s/m", rows, rows == 1 ? "damping" : "dampings",
      four_digits(*stiffest),
      four_digits(map.damping_N_s_m[static_cast<std::size_t>(stiffest - map.runs_N_m.begin())]));
}

void paint(Canvas& canvas, const StabilityMap& map) {
  const Axes axes = axes_of(map);
  const std::array<Curve, 3> curves = {curve_of(axes, map, map.runs_N_m),
                                       curve_of(axes, map, map.linear_N_m),
                                       curve_of(axes, map, map.passive_N_m)};
  draw_caption(canvas, {.title = map.title, .verdict = {}, .flags = {}}, "How stiff a wall may be",
               figures(map));
  fill_below(canvas, curves[0], axes.low.y());
  draw_y_axis(canvas, axes, 8);
  canvas.dashed_polyline(curves[2], kPassive, 2.5);
  canvas.polyline(curves[1], kLinear, 2.5);
  canvas.polyline(curves[0], kRuns, 2.0);
  canvas.dots(curves[0], curves[0].size() > 60 ? 3.0 : 4.5, kRuns);
  draw_x_axis(canvas, axes, round_ticks(axes.data_low.x(), axes.data_high.x(), 10),
              "damping B of the wall (N·s/m)");
  canvas.text({28.0, 0.5 * (axes.low.y() + axes.high.y())}, "stiffness K of the wall (N/m)",
              {.size = 19, .horizontal = Align::centre, .angle_deg = 90.0});
  write_word(canvas, axes, "stable", true, curves);
  write_word(canvas, axes, "unstable", false, curves);
  draw_legend(canvas);
}

}  // namespace

void draw_stability_map(PictureWindow& window, const StabilityMap& map) {
  add_page(window, [&](Canvas& canvas) { paint(canvas, map); });
}

}  // namespace hvp::draw
