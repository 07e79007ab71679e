#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include <fmt/format.h>

#include "app/draw/canvas.h"
#include "app/draw/latency_panels.h"
#include "app/draw/pictures.h"
#include "app/draw/plot_data.h"

namespace hvp::draw {
namespace {

using Point = Canvas::Point;

constexpr Colour kFrame = {38, 102, 150};
constexpr Colour kContact = {224, 236, 243};

struct Statistics {
  double best_us = 0.0;
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
    out.best_us = *std::min_element(latencies.begin(), latencies.end());
  }
  return out;
}

std::string microseconds(double us) { return four_digits(us) + " µs"; }

// Returns true if there is any.
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
  const std::string label = "budget " + microseconds(budget_us);
  const TextStyle text = {.size = 18,
                          .colour = style::kLate,
                          .bold = true,
                          .horizontal = at_right ? Align::high : Align::low,
                          .vertical = Align::low};
  const Point at(at_right ? axes.high.x() - 6.0 : axes.low.x() + 8.0, left.y() + 6.0);
  // Late frames stand behind it.
  const double begin = at_right ? at.x() - canvas.text_width(label, text) : at.x();
  canvas.rectangle({begin - 3.0, at.y() - 2.0},
                   {begin + canvas.text_width(label, text) + 3.0, at.y() + 18.0},
                   faded(style::kPaper, 0.8));
  canvas.text(at, label, text);
}

// The meaning of the marks that the picture has.
void draw_legend(Canvas& canvas, const Statistics& statistics, bool any_contact) {
  Legend legend(canvas, {1365.0, 886.0});
  if (any_contact) {
    const Point p = legend.entry("in contact");
    canvas.rectangle(p - Point(10.0, 9.0), p + Point(10.0, 9.0), kContact);
    canvas.frame(p - Point(10.0, 9.0), p + Point(10.0, 9.0), style::kGrid, 1.0);
  }
  if (statistics.skipped > 0) draw_cross(canvas, legend.entry("skipped"));
  if (statistics.late > 0) {
    canvas.disc(legend.entry("missed"), 4.5, style::kLate);
    canvas.disc(legend.entry("in time"), 4.5, kFrame);
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

// The range of the latencies with some room, where it is too flat to be seen in the main plot
// and is not a single value.
bool needs_enlarging(const Statistics& statistics, double plotted_us, Axes& strip) {
  if (statistics.worst == nullptr) return false;
  const double span = statistics.worst->latency_us - statistics.best_us;
  if (span > 0.08 * plotted_us || span < 1e-3) return false;
  strip.data_low.y() = statistics.best_us - 0.15 * span;
  strip.data_high.y() = statistics.worst->latency_us + 0.25 * span;
  return true;
}

std::string figures(const Statistics& statistics, std::size_t frames, double worst_us) {
  std::string line =
      fmt::format("{} {} · median {} · worst {} · ", frames, frames == 1 ? "frame" : "frames",
                  microseconds(statistics.median_us), microseconds(worst_us));
  if (statistics.late == 0 && statistics.skipped == 0) line += "all in time";
  if (statistics.late > 0) line += fmt::format("{} missed", statistics.late);
  if (statistics.late > 0 && statistics.skipped > 0) line += " · ";
  if (statistics.skipped > 0) line += fmt::format("{} skipped", statistics.skipped);
  return line;
}

void paint(Canvas& canvas, const std::vector<FrameRow>& frames, const Deadline& deadline,
           const Caption& caption) {
  const Statistics statistics = statistics_of(frames);
  const double worst_us = statistics.worst != nullptr ? statistics.worst->latency_us : 0.0;
  draw_caption(canvas, caption, "Latency of every frame",
               figures(statistics, frames.size(), worst_us));

  const auto first = static_cast<double>(frames.front().frame);
  const auto last = static_cast<double>(frames.back().frame);
  const double margin = std::max(0.5, 0.01 * (last - first));
  Axes whole{{110.0, 470.0},
             {1365.0, 872.0},
             {first - margin, 0.0},
             {last + margin, 1.12 * std::max({deadline.budget_us, worst_us, 1e-3})}};
  Axes strip = whole;
  const bool enlarged = needs_enlarging(statistics, whole.data_high.y(), strip);
  if (enlarged) {
    strip.high.y() = 585.0;
    whole.low.y() = 615.0;
  }

  const bool any_contact = shade_contact(canvas, whole, frames);
  draw_y_axis(canvas, whole, enlarged ? 4 : 6);
  draw_frames(canvas, whole, frames);
  draw_budget(canvas, whole, deadline.budget_us, statistics.worst);
  if (statistics.worst != nullptr) mark_worst(canvas, whole, *statistics.worst);
  if (enlarged) {
    shade_contact(canvas, strip, frames);
    const bool coarse = round_ticks(strip.data_low.y(), strip.data_high.y(), 3).values.size() < 2;
    draw_y_axis(canvas, strip, coarse ? 5 : 3);
    draw_frames(canvas, strip, frames);
    canvas.ring(strip.at(static_cast<double>(statistics.worst->frame), worst_us), 8.0, style::kInk,
                2.0);
    canvas.text(strip.high - Point(6.0, 4.0), "enlarged",
                {.size = 17,
                 .colour = style::kSoftInk,
                 .horizontal = Align::high,
                 .vertical = Align::high});
  }
  draw_x_axis(canvas, strip, whole_ticks(strip.data_low.x(), strip.data_high.x(), 10),
              fmt::format("frame (one every {} ms)", four_digits(deadline.period_us * 1e-3)));
  canvas.text({30.0, 0.5 * (strip.low.y() + whole.high.y())}, "latency (µs)",
              {.size = 19, .horizontal = Align::centre, .angle_deg = 90.0});
  draw_legend(canvas, statistics, any_contact);
  draw_attribution(canvas, deadline);
  draw_histogram(canvas, frames, deadline);
}

}  // namespace

void draw_latency(PictureWindow& window, const std::vector<FrameRow>& frames,
                  const Deadline& deadline, const Caption& caption) {
  add_page(window, [&](Canvas& canvas) { paint(canvas, frames, deadline, caption); });
}

}  // namespace hvp::draw
