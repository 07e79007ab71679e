#include "app/draw/latency_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include <fmt/format.h>
#include <vtkNew.h>
#include <vtkRenderer.h>

#include "app/draw/axis_ticks.h"
#include "app/draw/canvas.h"
#include "app/draw/picture_window.h"

namespace hvp::draw {
namespace {

using Point = Canvas::Point;

constexpr Colour kFrame = {38, 102, 150};
constexpr Colour kContact = {224, 236, 243};

// Colours of the parts, after Okabe and Ito's palette for the colour-blind.
constexpr std::array<Colour, 6> kPartColours = {
    {{0, 114, 178}, {230, 159, 0}, {0, 158, 115}, {204, 121, 167}, {86, 180, 233}, {213, 94, 0}}};
constexpr Colour kOther = {160, 160, 155};

// Data coordinates in a rectangle of the picture.
struct Axes {
  Point low;
  Point high;
  Point data_low;
  Point data_high;

  Point at(double x, double y) const {
    const Point share = (Point(x, y) - data_low).cwiseQuotient(data_high - data_low);
    return low + share.cwiseProduct(high - low);
  }
};

struct Statistics {
  double median_us = 0.0;
  std::size_t late = 0;
  std::size_t skipped = 0;
  const FrameRow* worst = nullptr;  // the first one of the largest latency
};

Statistics statistics_of(const std::vector<FrameRow>& frames) {
  Statistics out;
  std::vector<double> latencies;
  for (const FrameRow& row : frames) {
    if (std::isnan(row.latency_us)) {
      ++out.skipped;
      continue;
    }
    if (!row.in_time) ++out.late;
    latencies.push_back(row.latency_us);
    if (out.worst == nullptr || row.latency_us > out.worst->latency_us) out.worst = &row;
  }
  if (!latencies.empty()) {
    const auto middle = latencies.begin() + static_cast<std::ptrdiff_t>((latencies.size() - 1) / 2);
    std::nth_element(latencies.begin(), middle, latencies.end());
    out.median_us = *middle;
  }
  return out;
}

std::string microseconds(double us) { return four_digits(us) + " µs"; }

// Returns whether there is any.
bool shade_contact(Canvas& canvas, const Axes& axes, const std::vector<FrameRow>& frames) {
  bool any = false;
  for (std::size_t i = 0; i < frames.size();) {
    std::size_t end = i + 1;
    if (frames[i].contact_node >= 0) {
      any = true;
      while (end < frames.size() && frames[end].contact_node >= 0) ++end;
      const double left = axes.at(static_cast<double>(frames[i].frame) - 0.5, 0.0).x();
      const double right = axes.at(static_cast<double>(frames[end - 1].frame) + 0.5, 0.0).x();
      canvas.rectangle({std::max(left, axes.low.x()), axes.low.y()},
                       {std::min(right, axes.high.x()), axes.high.y()}, kContact);
    }
    i = end;
  }
  return any;
}

void draw_axes(Canvas& canvas, const Axes& axes, double period_us) {
  const TextStyle number = {.size = 18, .colour = style::kSoftInk};
  const Ticks y = round_ticks(axes.data_low.y(), axes.data_high.y(), 6);
  TextStyle left = number;
  left.horizontal = Align::high;
  for (std::size_t i = 0; i < y.values.size(); ++i) {
    const Point p = axes.at(axes.data_low.x(), y.values[i]);
    canvas.line(p, {axes.high.x(), p.y()}, style::kGrid, 1.0);
    canvas.text(p - Point(10.0, 0.0), y.labels[i], left);
  }
  const Ticks x = whole_ticks(axes.data_low.x(), axes.data_high.x(), 10);
  TextStyle below = number;
  below.horizontal = Align::centre;
  below.vertical = Align::high;
  for (std::size_t i = 0; i < x.values.size(); ++i) {
    const Point p = axes.at(x.values[i], axes.data_low.y());
    canvas.line(p, p - Point(0.0, 6.0), style::kSoftInk, 1.2);
    canvas.text(p - Point(0.0, 11.0), x.labels[i], below);
  }
  canvas.line(axes.low, {axes.high.x(), axes.low.y()}, style::kSoftInk, 1.4);
  canvas.line(axes.low, {axes.low.x(), axes.high.y()}, style::kSoftInk, 1.4);

  const TextStyle title = {.size = 19, .horizontal = Align::centre};
  canvas.text({0.5 * (axes.low.x() + axes.high.x()), axes.low.y() - 52.0},
              fmt::format("frame (one every {} ms)", four_digits(period_us * 1e-3)), title);
  TextStyle upright = title;
  upright.angle_deg = 90.0;
  canvas.text({30.0, 0.5 * (axes.low.y() + axes.high.y())}, "latency (µs)", upright);
}

void draw_cross(Canvas& canvas, const Point& at) {
  canvas.line(at - Point(4.0, 4.0), at + Point(4.0, 4.0), style::kLate, 1.8);
  canvas.line(at - Point(4.0, -4.0), at + Point(4.0, -4.0), style::kLate, 1.8);
}

void draw_frames(Canvas& canvas, const Axes& axes, const std::vector<FrameRow>& frames) {
  std::vector<Point> in_time;
  std::vector<Point> late;
  std::vector<Point> skipped;
  for (const FrameRow& row : frames) {
    const auto x = static_cast<double>(row.frame);
    if (std::isnan(row.latency_us))
      skipped.push_back(axes.at(x, axes.data_high.y()) - Point(0.0, 6.0));
    else
      (row.in_time ? in_time : late).push_back(axes.at(x, row.latency_us));
  }
  const double radius = frames.size() > 400 ? 2.3 : 3.0;
  canvas.dots(in_time, radius, faded(kFrame, 0.85));
  canvas.dots(late, radius + 0.5, style::kLate);
  for (const Point& p : skipped) draw_cross(canvas, p);
}

void draw_budget(Canvas& canvas, const Axes& axes, double budget_us, const FrameRow* worst) {
  const Point left = axes.at(axes.data_low.x(), budget_us);
  canvas.dashed_line(left, {axes.high.x(), left.y()}, style::kLate, 2.0);
  // The label stands at the right unless the worst frame is marked there.
  bool at_right = true;
  if (worst != nullptr) {
    const Point p = axes.at(static_cast<double>(worst->frame), worst->latency_us);
    at_right = std::abs(p.y() - left.y()) > 60.0 || p.x() < axes.high.x() - 640.0;
  }
  canvas.text({at_right ? axes.high.x() - 6.0 : axes.low.x() + 8.0, left.y() + 6.0},
              "budget " + microseconds(budget_us),
              {.size = 18,
               .colour = style::kLate,
               .bold = true,
               .horizontal = at_right ? Align::high : Align::low,
               .vertical = Align::low});
}

// From the right: what the marks mean, only those that are there.
void draw_legend(Canvas& canvas, const Statistics& statistics, bool any_contact) {
  double x = 1365.0;
  const auto entry = [&](const char* words) {
    const TextStyle text = {.size = 18, .horizontal = Align::high};
    canvas.text({x, 926.0}, words, text);
    x -= canvas.text_width(words, text) + 18.0;
    const Point sign(x, 926.0);
    x -= 30.0;
    return sign;
  };
  if (any_contact) {
    const Point p = entry("in contact");
    canvas.rectangle(p - Point(10.0, 9.0), p + Point(10.0, 9.0), kContact);
    canvas.frame(p - Point(10.0, 9.0), p + Point(10.0, 9.0), style::kGrid, 1.0);
  }
  if (statistics.skipped > 0) draw_cross(canvas, entry("skipped"));
  if (statistics.late > 0) {
    canvas.disc(entry("late"), 4.5, style::kLate);
    canvas.disc(entry("in time"), 4.5, kFrame);
  }
}

void mark_worst(Canvas& canvas, const Axes& axes, const FrameRow& worst) {
  const Point p = axes.at(static_cast<double>(worst.frame), worst.latency_us);
  canvas.ring(p, 8.0, style::kInk, 2.0);
  const bool left_half = p.x() < 0.6 * axes.low.x() + 0.4 * axes.high.x() + 200.0;
  canvas.text(p + Point(left_half ? 16.0 : -16.0, 16.0),
              fmt::format("worst: frame {}, {}", worst.frame, microseconds(worst.latency_us)),
              {.size = 18,
               .bold = true,
               .horizontal = left_half ? Align::low : Align::high,
               .vertical = Align::low});
}

std::string name_of(const Contribution& row) { return row.part + " · " + row.phase; }

void draw_attribution(Canvas& canvas, const Deadline& deadline) {
  constexpr double kTop = 322.0;
  constexpr double kRow = 34.0;
  constexpr double kRight = 1180.0;
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
  const double left = 52.0 + std::clamp(names, 240.0, 520.0);
  std::vector<std::string> parts;  // in the order of their first row: a colour each
  double y = kTop;
  for (const Contribution& row : rows) {
    auto part = std::find(parts.begin(), parts.end(), row.part);
    if (part == parts.end()) part = parts.insert(parts.end(), row.part);
    const Colour colour =
        &row == &rows.back() && row.part == "other"
            ? kOther
            : kPartColours[static_cast<std::size_t>(part - parts.begin()) % kPartColours.size()];
    const double length = longest > 0.0 ? (kRight - left) * row.us / longest : 0.0;
    const double middle = y - 0.5 * kRow;
    canvas.text({left - 12.0, middle}, name_of(row), {.horizontal = Align::high});
    canvas.rectangle({left, middle - 12.0}, {left + std::max(length, 1.5), middle + 12.0}, colour);
    canvas.text({left + length + 10.0, middle},
                fmt::format("{:.1f} µs   {:.1f} %", row.us, sum > 0 ? 100 * row.us / sum : 0),
                {.colour = style::kInk});
    y -= kRow;
  }
  canvas.line({left, kTop + 2.0}, {left, y - 2.0}, style::kSoftInk, 1.4);
}

void paint(Canvas& canvas, const std::vector<FrameRow>& frames, const Deadline& deadline) {
  const Statistics statistics = statistics_of(frames);
  const double worst_us = statistics.worst != nullptr ? statistics.worst->latency_us : 0.0;
  const auto first = static_cast<double>(frames.front().frame);
  const auto last = static_cast<double>(frames.back().frame);
  const double margin = std::max(0.5, 0.01 * (last - first));
  const Axes axes{{110.0, 470.0},
                  {1365.0, 890.0},
                  {first - margin, 0.0},
                  {last + margin, 1.12 * std::max({deadline.budget_us, worst_us, 1e-3})}};

  canvas.text({40.0, 963.0}, "Latency of every frame", {.size = 28, .bold = true});
  std::string line = fmt::format("{} {} · median {} · worst {} · ", frames.size(),
                                 frames.size() == 1 ? "frame" : "frames",
                                 microseconds(statistics.median_us), microseconds(worst_us));
  if (statistics.late == 0 && statistics.skipped == 0) line += "all in time";
  if (statistics.late > 0) line += fmt::format("{} late", statistics.late);
  if (statistics.late > 0 && statistics.skipped > 0) line += " · ";
  if (statistics.skipped > 0) line += fmt::format("{} skipped", statistics.skipped);
  canvas.text({40.0, 926.0}, line, {.size = 19, .colour = style::kSoftInk});

  const bool any_contact = shade_contact(canvas, axes, frames);
  draw_axes(canvas, axes, deadline.period_us);
  draw_frames(canvas, axes, frames);
  draw_budget(canvas, axes, deadline.budget_us, statistics.worst);
  draw_legend(canvas, statistics, any_contact);
  if (statistics.worst != nullptr) mark_worst(canvas, axes, *statistics.worst);
  draw_attribution(canvas, deadline);
}

}  // namespace

void draw_latency(PictureWindow& window, const std::vector<FrameRow>& frames,
                  const Deadline& deadline) {
  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(style::kPaper.red / 255.0, style::kPaper.green / 255.0,
                          style::kPaper.blue / 255.0);
  add_canvas(*renderer, [&](Canvas& canvas) { paint(canvas, frames, deadline); });
  window.add(*renderer, 0);
}

}  // namespace hvp::draw
