#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fit/qlv_problem.h"

namespace hvp::fit {

namespace {

constexpr std::size_t kFewest = 20;
constexpr double kLongestStroke = 1;  // m
constexpr double kStrongest = 100e3;  // N
constexpr double kUnevenness = 1.5;   // a step over the median
constexpr double kRisen = 0.05;       // of the range of force
constexpr double kMoved = 0.005;      // of the stroke

double range(const std::vector<double>& values) {
  const auto ends = std::minmax_element(values.begin(), values.end());
  return *ends.second - *ends.first;
}

void check_column(const std::vector<double>& values, const char* column, std::size_t rows) {
  if (values.size() != rows) {
    throw InputError(fmt::format("{}: {} values beside {} times; expected one a time", column,
                                 values.size(), rows));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) continue;
    throw InputError(fmt::format("{}: sample {} is no finite number", column, i + 1));
  }
}

double median_step(const std::vector<double>& time) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < time.size(); ++i) steps.push_back(time[i] - time[i - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

void check_steps(const std::vector<double>& time, double step) {
  for (std::size_t i = 1; i < time.size(); ++i) {
    const double dt = time[i] - time[i - 1];
    if (!(dt > 0)) {
      throw InputError(
          fmt::format("time: goes from {:g} s to {:g} s at sample {}; expected it to "
                      "grow",
                      time[i - 1], time[i], i + 1));
    }
    if (dt <= kUnevenness * step) continue;
    throw InputError(
        fmt::format("time: a step of {:g} s at sample {} among steps of {:g} s; "
                    "expected even steps, resample the record or cut it there",
                    dt, i + 1, step));
  }
}

void check(const IndentationLog& log) {
  if (log.time.size() < kFewest) {
    throw InputError(
        fmt::format("time: {} samples; expected at least {}", log.time.size(), kFewest));
  }
  check_column(log.time, "time", log.time.size());
  check_column(log.travel, "travel", log.time.size());
  check_column(log.force, "force", log.time.size());
  const double stroke = range(log.travel);
  if (!(stroke > 0)) throw InputError("travel: does not move; expected an indenter that presses");
  if (stroke > kLongestStroke) {
    throw InputError(
        fmt::format("travel: a stroke of {:g} m; expected at most {:g} m, is it in mm?", stroke,
                    kLongestStroke));
  }
  const double forces = range(log.force);
  if (!(forces > 0)) {
    throw InputError("force: is constant; expected one that grows as the indenter is pressed");
  }
  if (forces > kStrongest) {
    throw InputError(fmt::format("force: a range of {:g} N; expected at most {:g} N, is it in mN?",
                                 forces, kStrongest));
  }
}

// Whole samples at the beginning during which the indenter has not moved yet, but for one.
std::size_t at_rest(const std::vector<double>& travel) {
  const double moved = kMoved * range(travel);
  const auto first = std::find_if(travel.begin(), travel.end(), [&](double place) {
    return std::abs(place - travel.front()) > moved;
  });
  const auto samples = static_cast<std::size_t>(first - travel.begin());
  return samples > 0 ? samples - 1 : 0;
}

void leave_out(std::size_t samples, std::vector<double>& column) {
  column.erase(column.begin(), column.begin() + static_cast<std::ptrdiff_t>(samples));
}

double covariance(const std::vector<double>& a, const std::vector<double>& b) {
  double mean_a = 0;
  double mean_b = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    mean_a += a[i];
    mean_b += b[i];
  }
  mean_a /= static_cast<double>(a.size());
  mean_b /= static_cast<double>(a.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - mean_a) * (b[i] - mean_b);
  return sum;
}

}  // namespace

double PressedLog::stroke() const { return range(depth); }
double PressedLog::force_range() const { return range(force); }
double PressedLog::seconds() const { return time.back() - time.front(); }
double PressedLog::shallowest() const { return *std::min_element(depth.begin(), depth.end()); }
double PressedLog::deepest() const { return *std::max_element(depth.begin(), depth.end()); }
double PressedLog::before_contact() const { return force.front(); }

double PressedLog::first_loaded() const {
  const double risen = before_contact() + kRisen * force_range();
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (force[i] > risen) return depth[i];
  }
  return deepest();
}

PressedLog pressed(const IndentationLog& log) {
  check(log);
  PressedLog result{.time = log.time,
                    .depth = log.travel,
                    .force = log.force,
                    .direction = 1,
                    .step = median_step(log.time),
                    .warnings = {}};
  check_steps(log.time, result.step);

  if (covariance(log.travel, log.force) < 0) result.direction = -1;
  // A record begins where nothing is pressed yet. If it begins at the far end, what grows is not
  // the load.
  const double from_start = result.direction * (log.travel.front() - log.travel.back());
  const double half = 0.5 * range(log.travel);
  if (from_start > half) {
    result.direction = -result.direction;
    for (double& force : result.force) force = -force;
    result.warnings.emplace_back(
        "force: falls as the indenter leaves its first place; taken for pressing that counts as "
        "negative, and turned round");
  }
  for (double& depth : result.depth) depth *= result.direction;

  const std::size_t rest = at_rest(log.travel);
  if (rest == 0) return result;
  leave_out(rest, result.time);
  leave_out(rest, result.depth);
  leave_out(rest, result.force);
  if (result.time.size() < kFewest) {
    throw InputError(
        fmt::format("travel: {} samples from where it begins to move; expected at "
                    "least {}",
                    result.time.size(), kFewest));
  }
  result.warnings.push_back(fmt::format(
      "travel: the first {} samples are left out, the indenter has not moved yet", rest));
  return result;
}

}  // namespace hvp::fit
