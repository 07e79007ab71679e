#include "app/draw/decimation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace hvp::draw {
namespace {

using Stroke = std::vector<Eigen::Vector2d>;

// What is kept of one column, by the samples' places.
struct Column {
  long number = 0;
  std::size_t first = 0;
  std::size_t least = 0;
  std::size_t largest = 0;
  std::size_t last = 0;
};

void append(Stroke& stroke, const Column& column, std::span<const double> x,
            std::span<const double> y) {
  std::array<std::size_t, 4> kept = {column.first, column.least, column.largest, column.last};
  std::sort(kept.begin(), kept.end());
  const auto* const end = std::unique(kept.begin(), kept.end());
  for (const auto* i = kept.begin(); i != end; ++i) stroke.emplace_back(x[*i], y[*i]);
}

}  // namespace

std::vector<Stroke> strokes(std::span<const double> x, std::span<const double> y, double from,
                            double to, int columns) {
  std::vector<Stroke> out;
  Column column;
  bool open = false;  // a stroke, with a column that is not in it yet
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(y[i])) {
      if (open) append(out.back(), column, x, y);
      open = false;
      continue;
    }
    const long number = std::lround(std::floor((x[i] - from) / (to - from) * columns));
    if (open && number == column.number) {
      if (y[i] < y[column.least]) column.least = i;
      if (y[i] > y[column.largest]) column.largest = i;
      column.last = i;
      continue;
    }
    if (open) append(out.back(), column, x, y);
    if (!open) out.emplace_back();
    open = true;
    column = {number, i, i, i, i};
  }
  if (open) append(out.back(), column, x, y);
  return out;
}

std::vector<Stretch> stretches_below(std::span<const double> x, std::span<const double> y,
                                     double level, double gap) {
  std::vector<Stretch> out;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!(y[i] < level)) continue;
    const double to = x[std::min(i + 1, x.size() - 1)];
    if (!out.empty() && x[i] - out.back().to < gap) {
      out.back().to = to;
    } else {
      out.push_back({x[i], to});
    }
  }
  return out;
}

}  // namespace hvp::draw
