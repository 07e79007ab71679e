#include "models/files/time_spacing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace hvp::files {
namespace {

constexpr double kNearMedian = 0.2;
constexpr double kShareNearMedian = 0.8;
// In periods: an interval from which on a sample is missing, because there is room for one.
constexpr double kGap = 1.5;
// In periods: the error of adding up doubles, and of times with many digits.
constexpr double kInvisible = 1e-6;

double median_interval(const std::vector<double>& time) {
  std::vector<double> intervals(time.size() - 1);
  for (std::size_t i = 0; i < intervals.size(); ++i) intervals[i] = time[i + 1] - time[i];
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

bool was_ever_even(const std::vector<double>& time, double typical) {
  std::size_t near = 0;
  for (std::size_t i = 1; i < time.size(); ++i) {
    const double interval = time[i] - time[i - 1];
    if (std::abs(interval - typical) <= kNearMedian * typical) ++near;
  }
  return static_cast<double>(near) >= kShareNearMedian * static_cast<double>(time.size() - 1);
}

// The time by which a sample is later than an even spacing from the stretch's first one: small, so
// that sums over millions of them lose nothing.
double lateness(const std::vector<double>& time, const Stretch& stretch, double period,
                std::size_t i) {
  return time[i] - time[stretch.begin] - period * static_cast<double>(i - stretch.begin);
}

double mean_lateness(const std::vector<double>& time, const Stretch& stretch, double period) {
  double sum = 0;
  for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
    sum += lateness(time, stretch, period, i);
  }
  return sum / static_cast<double>(stretch.end - stretch.begin);
}

// The period from end to end of the longest stretch.
double provisional_period(const std::vector<double>& time, const std::vector<Stretch>& stretches) {
  const Stretch longest = *std::ranges::max_element(
      stretches, {}, [](const Stretch& stretch) { return stretch.end - stretch.begin; });
  return (time[longest.end - 1] - time[longest.begin]) /
         static_cast<double>(longest.end - longest.begin - 1);
}

// The common slope of the lines through the stretches.
double fitted_period(const std::vector<double>& time, const std::vector<Stretch>& stretches) {
  const double period = provisional_period(time, stretches);
  double products = 0;
  double squares = 0;
  for (const Stretch& stretch : stretches) {
    const double mean = mean_lateness(time, stretch, period);
    const double middle = 0.5 * static_cast<double>(stretch.end - stretch.begin - 1);
    for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
      const double place = static_cast<double>(i - stretch.begin) - middle;
      products += place * (lateness(time, stretch, period, i) - mean);
      squares += place * place;
    }
  }
  return period + products / squares;
}

void find_jitter(const std::vector<double>& time, Spacing& spacing) {
  double squares = 0;
  for (const Stretch& stretch : spacing.stretches) {
    const double mean = mean_lateness(time, stretch, spacing.period);
    for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
      const double distance =
          std::abs(lateness(time, stretch, spacing.period, i) - mean) / spacing.period;
      squares += distance * distance;
      if (!(distance > spacing.jitter)) continue;
      spacing.jitter = distance;
      spacing.strays = i;
    }
  }
  spacing.rms = std::sqrt(squares / static_cast<double>(time.size()));
}

// The unit of which all times are whole multiples, s: the typical interval or a small part of it; 0
// where there is none.
double unit_of(const std::vector<double>& time, double typical) {
  constexpr int kMostParts = 4;
  constexpr double kWhole = 1e-3;  // of the unit
  for (int parts = 1; parts <= kMostParts; ++parts) {
    const double unit = typical / parts;
    const bool whole = std::ranges::all_of(time, [&](double t) {
      const double units = (t - time.front()) / unit;
      return std::abs(units - std::round(units)) < kWhole;
    });
    if (whole) return unit;
  }
  return 0;
}

// Takes steps for the rounding of a clock's times where they are that, and returns true.
bool take_for_rounding(const std::vector<double>& time, Spacing& spacing) {
  constexpr double kOfTheUnit = 0.6;  // half a unit either way, and what the fit is off
  constexpr double kClock = 0.01;     // by which a clock may be wrong
  const double unit = unit_of(time, spacing.period);
  if (unit == 0) return false;
  std::size_t steps = 0;
  for (std::size_t i = 1; i < time.size(); ++i) {
    const double interval = time[i] - time[i - 1];
    if (interval > kGap * spacing.period) ++steps;
    if (interval > spacing.period + 1.5 * unit) return false;
  }
  // One step alone is as well a sample that is missing.
  if (steps < 2) return false;
  Spacing rounded;
  rounded.stretches.push_back({0, time.size()});
  rounded.period = fitted_period(time, rounded.stretches);
  if (std::abs(rounded.period / spacing.period - 1) > kClock) return false;
  find_jitter(time, rounded);
  if (!(rounded.jitter * rounded.period <= kOfTheUnit * unit)) return false;
  rounded.even = true;
  rounded.rounded_to = unit;
  spacing = rounded;
  return true;
}

}  // namespace

Spacing spacing_of(const std::vector<double>& time) {
  Spacing spacing;
  spacing.period = median_interval(time);
  spacing.stretches.push_back({0, time.size()});
  if (!was_ever_even(time, spacing.period)) {
    spacing.jitter = std::numeric_limits<double>::infinity();
    return spacing;
  }
  if (take_for_rounding(time, spacing)) return spacing;
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (time[i] - time[i - 1] <= kGap * spacing.period) continue;
    spacing.stretches.back().end = i;
    spacing.stretches.push_back({i, time.size()});
  }
  const double fitted = fitted_period(time, spacing.stretches);
  if (fitted > 0) spacing.period = fitted;
  find_jitter(time, spacing);
  spacing.even = spacing.jitter <= Spacing::kMostJitter && spacing.rms <= Spacing::kMostRms;
  return spacing;
}

bool space_evenly(std::vector<double>& time, const Spacing& spacing) {
  const double latest = std::max(std::abs(time.front()), std::abs(time.back()));
  const double rounding = 4 * std::numeric_limits<double>::epsilon() * latest / spacing.period;
  if (spacing.jitter <= kInvisible + rounding) return false;
  for (const Stretch& stretch : spacing.stretches) {
    const double first = time[stretch.begin] + mean_lateness(time, stretch, spacing.period);
    for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
      time[i] = first + spacing.period * static_cast<double>(i - stretch.begin);
    }
  }
  return true;
}

}  // namespace hvp::files
