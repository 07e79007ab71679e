#include "app/stability/edge_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace hvp::app {

namespace {

constexpr double kSoftest = 1e-2;  // below it nothing is a wall
constexpr double kStride = 1.5;
// Where it looks below an edge: to a third of it.
constexpr int kLooks = 5;
constexpr double kLookStep = 0.8;

}  // namespace

EdgeSearch::EdgeSearch(TryAt try_at, double largest_N_m, const Progress& progress, std::string what)
    : try_at_(std::move(try_at)),
      largest_N_m_(largest_N_m),
      progress_(progress),
      what_(std::move(what)) {}

bool EdgeSearch::begin(double stiffness) {
  stable(stiffness);
  return !clamped_;
}

StabilityEdge EdgeSearch::find(double guess, double tolerance) {
  bracket(guess);
  return bisect(tolerance);
}

StabilityEdge EdgeSearch::look_below(double tolerance) {
  const double found = below_;
  double softest_unstable = 0;
  for (int step = 1; step <= kLooks; ++step) {
    const double at = found * std::pow(kLookStep, step);
    if (at < kSoftest) break;
    if (!stable(at)) softest_unstable = at;
  }
  if (softest_unstable == 0) return edge_;
  below_ = 0;
  above_ = softest_unstable;
  go_down(softest_unstable, 1 / kLookStep);
  return bisect(tolerance);
}

StabilityEdge EdgeSearch::bisect(double tolerance) {
  while (below_ > 0 && above_ > 0 && above_ - below_ > tolerance * below_) {
    const double middle = std::sqrt(below_ * above_);
    (stable(middle) ? below_ : above_) = middle;
  }
  edge_.stiffness_max = below_;
  return edge_;
}

bool EdgeSearch::stable(double stiffness) {
  ++edge_.runs;
  if (progress_) progress_(fmt::format("{}run {}: {:.5g} N/m", what_, edge_.runs, stiffness));
  const Trial trial = try_at_(stiffness);
  clamped_ = trial.clamped;
  pressed_ = pressed_ && trial.pressed;
  if (!trial.decided) {
    edge_.undecided_N_m = std::max(edge_.undecided_N_m, stiffness);
  } else if (!trial.stable && (edge_.unstable_from == 0 || stiffness < edge_.unstable_from)) {
    edge_.unstable_from = stiffness;
  }
  if (delay_s_ == 0) delay_s_ = trial.delay_s;
  if (trial.stable && stiffness >= below_) {
    edge_.left_m = trial.amplitude_m;
    edge_.stuck = !trial.moved;
  }
  return trial.stable;
}

void EdgeSearch::bracket(double guess) {
  double at = std::clamp(guess, kSoftest, largest_N_m_);
  double stride = 1.02;  // the guess is a good one more often than not
  if (!stable(at)) {
    above_ = at;
    go_down(at, stride);
    return;
  }
  below_ = at;
  while (above_ == 0 && at < largest_N_m_) {
    at = std::min(largest_N_m_, at * stride);
    stride = std::max(stride, kStride);
    (stable(at) ? below_ : above_) = at;
  }
}

void EdgeSearch::go_down(double from, double stride) {
  double at = from;
  while (below_ == 0 && at > kSoftest && edge_.undecided_N_m == 0) {
    at = std::max(kSoftest, at / stride);
    stride = std::max(stride, kStride);
    (stable(at) ? below_ : above_) = at;
  }
}

void StabilityEdge::report(config::Figures& f) const {
  const auto stiffness = [&f](std::string_view key, double value, std::string_view help) {
    f.quantity(key, value > 0 ? std::optional(value) : std::nullopt, "N/m", help);
  };
  f.quantity("push_N", push_N, "N",
             "with which the device leans on the wall; null: the scenario's own motion, or a body");
  stiffness("stiffness_max", stiffness_max, "the stiffest that was stable; null where none was");
  stiffness("unstable_from", unstable_from, "the softest that was not; null where all were");
  f.quantity("left_m", left_m, "m", "half of peak to peak of the swing that is left there");
  f.truth("stuck", stuck, "friction held the device in that run");
  f.truth("clamped", clamped, "a force is clamped even in a soft wall: the edge is the clamp's");
  stiffness("undecided_N_m", undecided_N_m,
            "here and below the device swings more slowly than a run is long");
  f.count("runs", runs, "of the platform");
}

}  // namespace hvp::app
