#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/draw/canvas.h"
#include "app/draw/picture_window.h"
#include "app/draw/pictures.h"
#include "app/draw/plot_data.h"

namespace hvp::draw {
namespace {

using Point = Canvas::Point;

constexpr double kLoopLeft = 120.0;
constexpr double kLoopRight = 1365.0;
constexpr double kTop = 862.0;     // of the first panel
constexpr double kHeight = 230.0;  // of a panel
constexpr double kPitch = 270.0;   // from panel to panel
constexpr double kWords = 30.0;  // at the top of the energy's panel, for the words on its stretches

// After Okabe and Ito's palette for the colour-blind.
constexpr Colour kIntended = {240, 185, 80};
constexpr Colour kTrue = {38, 102, 150};
constexpr Colour kMotor = {213, 94, 0};
constexpr Colour kHand = {0, 140, 105};
constexpr Colour kStored = {86, 160, 215};
constexpr Colour kPort = {120, 50, 110};
constexpr double kBroad = 5.0;
constexpr double kNormal = 2.0;
constexpr double kThin = 1.0;

// A line of the first probe, and those of the further ones.
struct Line {
  std::string name;
  Colour colour;
  double width;
  std::vector<const std::vector<double>*> of_probe;
};

struct LoopPanel {
  std::string label;  // up the side, before the unit
  std::string symbol;
  double preferred_unit;
  bool from_zero;
  std::vector<Line> lines;  // the lowest first
  std::vector<Stretch> active;
};

struct TimeAxis {
  const std::vector<double>& time_s;
  double from_s = 0;
  double to_s = 0;
  Unit unit;
  Ticks ticks;  // in the unit
};

bool any_value(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

// Leaves out a line without any value: no hand grips the device.
template <class Values>
Line line_of(const LoopSeries& loop, const char* name, Colour colour, double width, Values values) {
  Line line{name, colour, width, {}};
  for (const ProbeSeries& probe : loop.probes) {
    if (any_value(values(probe))) line.of_probe.push_back(&values(probe));
  }
  return line;
}

Range plotted_range(const LoopPanel& panel) {
  Range range;
  bool first = !panel.from_zero;
  for (const Line& line : panel.lines) {
    for (const auto* values : line.of_probe) {
      const Range one = range_of(*values);
      if (first) range = one;
      first = false;
      range.include(one);
    }
  }
  return range;
}

Axes axes_of(const LoopPanel& panel, double top, const Range& range, const TimeAxis& time,
             const Unit& unit) {
  const double largest = std::max(std::abs(range.least), std::abs(range.largest));
  // A value that does not move is a flat line, however its last digits differ.
  const double size =
      std::max({range.size(), 1e-3 * largest, largest > 0.0 ? 0.0 : panel.preferred_unit});
  const double slack = 0.5 * (size - range.size()) + 0.06 * size;
  const double words = panel.active.empty() ? 0.0 : size * kWords / (kHeight - kWords);
  return {{kLoopLeft, top - kHeight},
          {kLoopRight, top},
          {time.from_s / time.unit.size, (range.least - slack) / unit.size},
          {time.to_s / time.unit.size, (range.largest + slack + words) / unit.size}};
}

void shade(Canvas& canvas, const Axes& axes, const Stretch& stretch, const TimeAxis& time) {
  const double left = axes.at(stretch.from / time.unit.size, 0.0).x();
  const double right = axes.at(stretch.to / time.unit.size, 0.0).x();
  canvas.rectangle({left, axes.low.y()}, {std::max(right, left + 1.0), axes.high.y()},
                   faded(style::kLate, 0.16));
}

void draw_values(Canvas& canvas, const Axes& axes, const std::vector<double>& values,
                 const TimeAxis& time, const Unit& unit, Colour colour, double width) {
  constexpr int kColumns = static_cast<int>(kLoopRight - kLoopLeft) * kSupersampling;
  for (auto& stroke : strokes(time.time_s, values, time.from_s, time.to_s, kColumns)) {
    for (Point& p : stroke) p = axes.at(p.x() / time.unit.size, p.y() / unit.size);
    canvas.polyline(stroke, colour, width);
  }
}

void draw_lines(Canvas& canvas, const Axes& axes, const LoopPanel& panel, const TimeAxis& time,
                const Unit& unit) {
  for (const Line& line : panel.lines) {
    for (std::size_t i = line.of_probe.size(); i-- > 0;) {
      draw_values(canvas, axes, *line.of_probe[i], time, unit, line.colour,
                  i == 0 ? line.width : kThin);
    }
  }
}

void draw_legend(Canvas& canvas, const Axes& axes, const LoopPanel& panel) {
  Legend legend(canvas, axes.high + Point(0.0, 18.0));
  for (auto line = panel.lines.rbegin(); line != panel.lines.rend(); ++line) {
    if (line->of_probe.empty()) continue;
    const Point p = legend.entry(line->name);
    canvas.line(p - Point(12.0, 0.0), p + Point(12.0, 0.0), line->colour,
                std::max(line->width, 3.0));
  }
}

// Writes the words over the longest stretch, inside the panel.
void name_active(Canvas& canvas, const Axes& axes, const LoopPanel& panel, const TimeAxis& time) {
  if (panel.active.empty()) return;
  const Stretch longest = *std::max_element(
      panel.active.begin(), panel.active.end(),
      [](const Stretch& a, const Stretch& b) { return a.to - a.from < b.to - b.from; });
  const std::string words = "active: the loop feeds energy in";
  const TextStyle text = {
      .size = 19, .colour = style::kLate, .bold = true, .horizontal = Align::centre};
  const double half = 0.5 * canvas.text_width(words, text) + 8.0;
  const double middle = axes.at(0.5 * (longest.from + longest.to) / time.unit.size, 0.0).x();
  canvas.text(
      {std::clamp(middle, axes.low.x() + half, axes.high.x() - half), axes.high.y() - 0.5 * kWords},
      words, text);
}

// Returns its axes.
Axes draw_panel(Canvas& canvas, const LoopPanel& panel, double top, const TimeAxis& time) {
  const Range range = plotted_range(panel);
  const double largest = std::max(std::abs(range.least), std::abs(range.largest));
  const Unit unit = unit_for(largest, panel.symbol, panel.preferred_unit);
  Axes axes = axes_of(panel, top, range, time, unit);

  for (const Stretch& stretch : panel.active) shade(canvas, axes, stretch, time);
  for (const double tick : time.ticks.values) {
    const double x = axes.at(tick, 0.0).x();
    canvas.line({x, axes.low.y()}, {x, axes.high.y()}, style::kGrid, 1.0);
  }
  draw_y_axis(canvas, axes, 7);
  if (panel.from_zero) {
    const Point zero = axes.at(axes.data_low.x(), 0.0);
    canvas.line(zero, {axes.high.x(), zero.y()}, style::kSoftInk, 1.4);
  }
  draw_lines(canvas, axes, panel, time, unit);
  name_active(canvas, axes, panel, time);
  draw_legend(canvas, axes, panel);
  canvas.text({28.0, 0.5 * (axes.low.y() + axes.high.y())},
              fmt::format("{} ({})", panel.label, unit.name),
              {.size = 19, .horizontal = Align::centre, .angle_deg = 90.0});
  return axes;
}

// The energy that the least of the ports has absorbed at each time where a loop has fed energy in,
// as the run's own observer says; else zero.
std::vector<double> fed_in(const LoopSeries& loop) {
  std::vector<double> out(loop.time_s.size(), 0.0);
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (const ProbeSeries& probe : loop.probes) {
      if (probe.fed_in[i] == 1.0) out[i] = std::min(out[i], probe.port_J[i]);
    }
  }
  return out;
}

std::string with_unit(double value, const char* symbol, double preferred) {
  const Unit unit = unit_for(value, symbol, preferred);
  return four_digits(value / unit.size) + " " + unit.name;
}

std::string figures(const LoopSeries& loop, std::size_t axis, double fed_in_J) {
  const ProbeSeries& probe = loop.probes.front();
  const Range motor = range_of(probe.motor_N[axis]);
  const std::size_t frames = loop.time_s.size();
  return fmt::format(
      "{} {} · the tip moves {} along {} · motor up to {} · {}", frames,
      frames == 1 ? "frame" : "frames", with_unit(range_of(probe.tip_m[axis]).size(), "m", 1e-3),
      "xyz"[axis], with_unit(std::max(-motor.least, motor.largest), "N", 1.0),
      fed_in_J > 0.0 ? fmt::format("the loop has fed in up to {}", with_unit(fed_in_J, "J", 1e-3))
                     : "the loop feeds no energy in");
}

// The axis reaches to the end of the last frame.
TimeAxis time_axis(const std::vector<double>& time_s) {
  const double from = time_s.front();
  const auto frames = static_cast<double>(time_s.size());
  const double between = time_s.back() - from;
  const double to = from + (between > 0.0 ? between * frames / (frames - 1.0) : 1e-3);
  const Unit unit = unit_for(to, "s", 1.0);
  return {time_s, from, to, unit, round_ticks(from / unit.size, to / unit.size, 10)};
}

void paint(Canvas& canvas, const LoopSeries& loop, const Caption& caption) {
  const std::size_t axis = main_axis(loop.probes.front());
  const char name = "xyz"[axis];
  const TimeAxis time = time_axis(loop.time_s);
  const double pixel_s = (time.to_s - time.from_s) / (kLoopRight - kLoopLeft);
  const std::vector<double> active = fed_in(loop);
  draw_caption(canvas, caption, "Closed loop", figures(loop, axis, -range_of(active).least));

  const auto line = [&](const char* what, Colour colour, double width, auto values) {
    return line_of(loop, what, colour, width, values);
  };
  const std::vector<LoopPanel> panels = {
      {fmt::format("position {}", name),
       "m",
       1e-3,
       false,
       {line(
            "intended by the hand", kIntended,
            kBroad, [=](const ProbeSeries& p) -> auto& { return p.intended_m[axis]; }),
        line(
            "true", kTrue, kNormal, [=](const ProbeSeries& p) -> auto& { return p.tip_m[axis]; })},
       {}},
      {fmt::format("force on the tip {}", name),
       "N",
       1.0,
       true,
       {line(
            "hand", kHand, kNormal, [=](const ProbeSeries& p) -> auto& { return p.hand_N[axis]; }),
        line(
            "motor", kMotor,
            kNormal, [=](const ProbeSeries& p) -> auto& { return p.motor_N[axis]; })},
       {}},
      {"energy",
       "J",
       1e-3,
       true,
       {line(
            "stored in the springs", kStored, kNormal,
            [](const ProbeSeries& p) -> auto& { return p.stored_J; }),
        line(
            "absorbed by the loop", kPort, kNormal,
            [](const ProbeSeries& p) -> auto& { return p.port_J; })},
       stretches_below(time.time_s, active, 0.0, pixel_s)}};
  double top = kTop;
  for (const LoopPanel& panel : panels) {
    const Axes axes = draw_panel(canvas, panel, top, time);
    if (&panel == &panels.back()) {
      draw_x_axis(canvas, axes, time.ticks, fmt::format("time ({})", time.unit.name));
    }
    top -= kPitch;
  }
  if (loop.probes.size() > 1)
    canvas.text({kLoopLeft, kTop + 18.0}, "thin: further probes", {.colour = style::kSoftInk});
}

}  // namespace

void draw_loop(PictureWindow& window, const LoopSeries& loop, const Caption& caption) {
  add_page(window, [&](Canvas& canvas) { paint(canvas, loop, caption); });
}

}  // namespace hvp::draw
