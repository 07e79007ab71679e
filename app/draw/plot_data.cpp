#include "app/draw/plot_data.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

namespace hvp::draw {

namespace {

Ticks ticks_with_step(double low, double high, double step) {
  Ticks ticks;
  ticks.step = step;
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  // A tick that rounding puts a hair outside still belongs to the axis.
  const double slack = 1e-9 * (high - low);
  for (double n = std::ceil((low - slack) / step); n * step <= high + slack; ++n) {
    ticks.values.push_back(n * step + 0.0);  // + 0.0: no "-0"
    ticks.labels.push_back(fmt::format("{:.{}f}", ticks.values.back(), decimals));
  }
  return ticks;
}

double round_step(double low, double high, int wanted) {
  const double raw = (high - low) / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= raw * (1.0 - 1e-9)) return factor * power;
  return 10.0 * power;
}

}  // namespace

Ticks round_ticks(double low, double high, int wanted) {
  return ticks_with_step(low, high, round_step(low, high, wanted));
}

Ticks whole_ticks(double low, double high, int wanted) {
  return ticks_with_step(low, high, std::max(1.0, round_step(low, high, wanted)));
}

std::string four_digits(double value) {
  const double size = std::abs(value);
  if (size == 0.0) return "0";
  if (size >= 1e7 || size < 1e-5) return fmt::format("{:.3e}", value);
  const int decimals = std::clamp(3 - static_cast<int>(std::floor(std::log10(size))), 0, 8);
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (decimals > 0) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text;
}

Unit unit_for(double largest, std::string_view symbol, double preferred) {
  constexpr std::array kPrefixes = {"p", "n", "µ", "m", "", "k", "M", "G", "T"};
  constexpr int kNone = 4;
  const bool fits = largest == 0.0 || (largest >= 0.01 * preferred && largest < 1e4 * preferred);
  const double thousands = std::floor(std::log10(fits ? preferred : largest) / 3.0 + 1e-9);
  const double size = std::pow(1000.0, thousands);
  const double prefix = kNone + thousands;
  if (prefix < 0.0 || prefix >= static_cast<double>(kPrefixes.size()))
    return {size, fmt::format("1e{:.0f} {}", 3.0 * thousands, symbol)};
  return {size, fmt::format("{}{}", kPrefixes.at(static_cast<std::size_t>(prefix)), symbol)};
}

namespace {

using Stroke = std::vector<Eigen::Vector2d>;

// The samples that are kept of one column, by their indices.
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

namespace {

// Nearest rank, as summary.json's percentiles.
double percentile(const std::vector<double>& ascending, double share) {
  const auto rank = std::ceil(share * static_cast<double>(ascending.size()));
  return ascending[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

}  // namespace

LatencyBins latency_bins(std::vector<double> latencies, double budget_us, int wanted,
                         const std::vector<double>& missed) {
  LatencyBins out;
  if (latencies.empty()) return out;
  std::sort(latencies.begin(), latencies.end());
  out.p50 = percentile(latencies, 0.50);
  out.p99 = percentile(latencies, 0.99);

  const double low = std::min(latencies.front(), budget_us);
  const double high = std::max({latencies.back(), budget_us, low + 1e-3});
  out.width = round_ticks(low, high, wanted).step;
  for (const double us : latencies) {
    // Bin 0 ends at the budget: what is not above it is in time.
    const double number = std::ceil((us - budget_us) / out.width);
    const double to = budget_us + number * out.width;
    if (out.bins.empty() || out.bins.back().to != to) {
      out.bins.push_back({to - out.width, to, 0, 0, us > budget_us});
    }
    ++out.bins.back().frames;
    if (us > budget_us) ++out.bins.back().missed;
    out.fullest = std::max(out.fullest, out.bins.back().frames);
  }
  for (const double us : missed) {
    for (LatencyBins::Bin& bin : out.bins) {
      if (!bin.late && bin.from < us && us <= bin.to) ++bin.missed;
    }
  }
  return out;
}

}  // namespace hvp::draw
