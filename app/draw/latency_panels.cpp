#include "app/draw/latency_panels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/draw/canvas.h"
#include "app/draw/plot_data.h"
#include "vp/frame/frame.h"

namespace hvp::draw {

namespace {

constexpr Colour kOther = {160, 160, 155};

// After Okabe and Ito's palette for the colour-blind; one part, one colour, in every picture.
constexpr auto kColourOfPart = std::to_array<Colour>({{0, 158, 115},     // host
                                                      {230, 159, 0},     // bus
                                                      {0, 114, 178},     // fpga
                                                      {204, 121, 167},   // daq
                                                      {86, 180, 233}});  // device
static_assert(kColourOfPart.size() == vp::kParts, "a part has no colour");

Colour colour_of(std::string_view part) {
  const auto found = std::ranges::find(vp::kPartNames, part);
  if (found == vp::kPartNames.end()) return kOther;
  return kColourOfPart.at(static_cast<std::size_t>(found - vp::kPartNames.begin()));
}

std::string name_of(const Contribution& row) { return row.part + " · " + row.phase; }

}  // namespace

void draw_attribution(Canvas& canvas, const Deadline& deadline) {
  constexpr double kTop = 322.0;
  constexpr double kRow = 34.0;
  constexpr double kRight = 610.0;
  canvas.text({40.0, 356.0}, "Where the worst frame's time went", {.size = 24, .bold = true});
  const auto rows = largest_contributions(deadline.attribution, 0.01, 9);
  if (rows.empty()) {
    canvas.text({40.0, kTop - 10.0}, "summary.json attributes nothing",
                {.colour = style::kSoftInk});
    return;
  }
  double sum = 0.0;
  double longest = 0.0;
  double names = 0.0;
  for (const Contribution& row : rows) {
    sum += row.us;
    longest = std::max(longest, row.us);
    names = std::max(names, canvas.text_width(name_of(row)));
  }
  const double left = 52.0 + std::clamp(names, 160.0, 330.0);
  double y = kTop;
  for (const Contribution& row : rows) {
    const double length = longest > 0.0 ? (kRight - left) * row.us / longest : 0.0;
    const double middle = y - 0.5 * kRow;
    canvas.text({left - 12.0, middle}, name_of(row), {.horizontal = Align::high});
    canvas.rectangle({left, middle - 12.0}, {left + std::max(length, 1.5), middle + 12.0},
                     colour_of(row.part));
    canvas.text({left + length + 10.0, middle},
                fmt::format("{:.1f} µs   {:.1f} %", row.us, sum > 0 ? 100 * row.us / sum : 0),
                {.colour = style::kInk});
    y -= kRow;
  }
  canvas.line({left, kTop + 2.0}, {left, y - 2.0}, style::kSoftInk, 1.4);
}

namespace {

using Point = Canvas::Point;

constexpr double kTitle = 356.0;
constexpr double kLeftEdge = 815.0;  // of the histogram with its labels
constexpr double kLeast = 0.5;       // frames at the foot of the axis: a single one has a height

// The latencies of all frames, or of the missed ones alone.
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

// A line up from the foot with its name beside its upper end. A line is as high as its name, so
// that a name meets only the lines of the names above it.
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

// Puts the name on its preferred side, or on the other one where a line or the picture's edge is in
// the way.
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
  // Each name has a row of its own, since their latencies may be equal.
  draw_marks(canvas, axes,
             {{bins.p50, name("p50", bins.p50), 9.0, {.size = 17, .horizontal = Align::high}},
              {bins.p99, name("p99", bins.p99), 29.0, {.size = 17}},
              {deadline.budget_us,
               name("budget", deadline.budget_us),
               49.0,
               {.size = 17, .colour = style::kLate, .bold = true, .horizontal = Align::high}}});
}

}  // namespace hvp::draw
