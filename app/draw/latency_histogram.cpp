#include "app/draw/latency_histogram.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/draw/axes.h"
#include "app/draw/axis_ticks.h"
#include "app/draw/canvas.h"
#include "app/draw/latency_bins.h"

namespace hvp::draw {
namespace {

using Point = Canvas::Point;

constexpr double kTitle = 356.0;
constexpr double kLeftEdge = 815.0;  // of what belongs to the histogram
constexpr double kLeast = 0.5;       // frames at the foot of the axis: a single one has a height

// Of every frame, or of those missed alone.
std::vector<double> latencies_of(const std::vector<FrameRow>& frames, bool missed) {
  std::vector<double> latencies;
  for (const FrameRow& row : frames) {
    if (missed && row.in_time) continue;
    if (!std::isnan(row.latency_us)) latencies.push_back(row.latency_us);
  }
  return latencies;
}

double height(std::size_t frames) { return std::log10(static_cast<double>(frames)); }

Axes axes_of(const LatencyBins& bins, double budget_us) {
  const double low = std::min(bins.bins.front().from, budget_us);
  const double high = std::max(bins.bins.back().to, budget_us);
  const double margin = std::max(bins.width, 0.03 * (high - low));
  return {{890.0, 74.0},
          {1365.0, 268.0},
          {std::max(low - margin, 0.0), std::log10(kLeast)},
          {high + margin, height(bins.fullest) * 1.06 + 0.2}};
}

void draw_counts(Canvas& canvas, const Axes& axes, std::size_t fullest) {
  for (std::size_t frames = 1; frames <= fullest; frames *= 10) {
    const Point p = axes.at(axes.data_low.x(), height(frames));
    canvas.line(p, {axes.high.x(), p.y()}, style::kGrid, 1.0);
    canvas.text(p - Point(10.0, 0.0), fmt::format("{}", frames),
                {.size = 17, .colour = style::kSoftInk, .horizontal = Align::high});
  }
}

void draw_bars(Canvas& canvas, const Axes& axes, const LatencyBins& bins, Colour in_time) {
  // A bin narrower than that would not be seen where it stands alone.
  constexpr double kNarrowest = 3.0;
  for (const LatencyBins::Bin& bin : bins.bins) {
    const Point low = axes.at(bin.from, axes.data_low.y());
    Point high = axes.at(bin.to, height(bin.frames));
    high.x() = std::max(high.x() - 1.0, low.x() + kNarrowest);
    canvas.rectangle(low, high, bin.missed == bin.frames ? style::kLate : in_time);
    if (bin.missed == 0 || bin.missed == bin.frames) continue;
    canvas.rectangle(low, {high.x(), axes.at(bin.from, height(bin.missed)).y()}, style::kLate);
  }
}

void draw_latency_axis(Canvas& canvas, const Axes& axes) {
  canvas.line(axes.low, {axes.high.x(), axes.low.y()}, style::kSoftInk, 1.4);
  const Ticks x = round_ticks(axes.data_low.x(), axes.data_high.x(), 5);
  for (std::size_t i = 0; i < x.values.size(); ++i) {
    const Point p = axes.at(x.values[i], axes.data_low.y());
    canvas.line(p, p - Point(0.0, 5.0), style::kSoftInk, 1.2);
    canvas.text(p - Point(0.0, 9.0), x.labels[i],
                {.size = 17,
                 .colour = style::kSoftInk,
                 .horizontal = Align::centre,
                 .vertical = Align::high});
  }
  canvas.text({0.5 * (axes.low.x() + axes.high.x()), axes.low.y() - 44.0}, "latency (µs)",
              {.size = 18, .horizontal = Align::centre});
  canvas.text({axes.low.x() - 62.0, 0.5 * (axes.low.y() + axes.high.y())}, "frames",
              {.size = 18, .horizontal = Align::centre, .angle_deg = 90.0});
}

// A line up from the foot with its name beside its upper end. The higher one's name is, the higher
// its line, so that a name meets only the lines of those above it.
struct Mark {
  double us;
  std::string name;
  double above;  // of the name, over the plot
  TextStyle text;
};

void draw_line(Canvas& canvas, const Axes& axes, const Mark& mark) {
  const Point low = axes.at(mark.us, axes.data_low.y());
  const Point high(low.x(), axes.high.y() + mark.above + 9.0);
  if (mark.text.bold) {
    canvas.dashed_line(low, high, mark.text.colour, 2.0);
  } else {
    canvas.line(low, high, mark.text.colour, 1.6);
  }
}

// On its preferred side, or on the other one where a line or the picture's edge is in the way.
void draw_name(Canvas& canvas, const Axes& axes, const Mark& mark,
               const std::vector<Mark>& higher) {
  constexpr double kPadding = 6.0;
  const double width = canvas.text_width(mark.name, mark.text) + 2.0 * kPadding;
  const Point at(axes.at(mark.us, 0.0).x(), axes.high.y() + mark.above);
  const auto fits = [&](double from, double to) {
    return from >= kLeftEdge && to <= axes.high.x() + kPadding &&
           std::none_of(higher.begin(), higher.end(), [&](const Mark& other) {
             const double x = axes.at(other.us, 0.0).x();
             return x > from && x < to;
           });
  };
  const bool left_fits = fits(at.x() - width, at.x());
  const bool right_fits = fits(at.x(), at.x() + width);
  TextStyle text = mark.text;
  if (text.horizontal == Align::low ? !right_fits && left_fits : !left_fits && right_fits) {
    text.horizontal = text.horizontal == Align::low ? Align::high : Align::low;
  }
  canvas.text(at + Point(text.horizontal == Align::low ? kPadding : -kPadding, 0.0), mark.name,
              text);
}

void draw_marks(Canvas& canvas, const Axes& axes, std::vector<Mark> lowest_first) {
  for (const Mark& mark : lowest_first) draw_line(canvas, axes, mark);
  while (!lowest_first.empty()) {
    const Mark mark = lowest_first.front();
    lowest_first.erase(lowest_first.begin());
    draw_name(canvas, axes, mark, lowest_first);
  }
}

}  // namespace

void draw_histogram(Canvas& canvas, const std::vector<FrameRow>& frames, const Deadline& deadline) {
  constexpr Colour kInTime = {38, 102, 150};
  constexpr int kBins = 50;
  canvas.text({kLeftEdge, kTitle}, "How often which latency", {.size = 24, .bold = true});
  const LatencyBins bins = latency_bins(latencies_of(frames, false), deadline.budget_us, kBins,
                                        latencies_of(frames, true));
  if (bins.bins.empty()) {
    canvas.text({kLeftEdge, 312.0}, "no frame has a latency", {.colour = style::kSoftInk});
    return;
  }
  const Axes axes = axes_of(bins, deadline.budget_us);
  draw_counts(canvas, axes, bins.fullest);
  draw_bars(canvas, axes, bins, kInTime);
  draw_latency_axis(canvas, axes);

  const auto name = [](const char* what, double us) {
    return fmt::format("{} {} µs", what, four_digits(us));
  };
  // Each on a row of its own: they may be one latency.
  draw_marks(canvas, axes,
             {{bins.p50, name("p50", bins.p50), 9.0, {.size = 17, .horizontal = Align::high}},
              {bins.p99, name("p99", bins.p99), 29.0, {.size = 17}},
              {deadline.budget_us,
               name("budget", deadline.budget_us),
               49.0,
               {.size = 17, .colour = style::kLate, .bold = true, .horizontal = Align::high}}});
}

}  // namespace hvp::draw
