#include "models/fit/tail_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>

#include <ceres/jet.h>
#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fit/likelihood.h"

namespace hvp::fit {

namespace {

constexpr std::int64_t kFewestExceedances = 100;
constexpr std::size_t kFewestTailBins = 3;
constexpr double kRefused = 0.05;
constexpr double kLargestShare = 0.5;
constexpr std::array<double, 10> kShares = {0.1,  0.05, 0.02, 0.01, 0.005,
                                            2e-3, 1e-3, 5e-4, 2e-4, 1e-4};
constexpr std::array<const char*, 5> kRare = {"1e-4", "1e-5", "1e-6", "1e-7", "1e-8"};
// As [host.wake_up] admits them.
constexpr double kLeastShape = -0.5;
constexpr double kMostShape = 1;

// What lies above the threshold, each bin's ends above it, s. The last may have no end.
struct Exceedances {
  double from_s = 0;
  double share = 0;
  std::int64_t count = 0;
  std::int64_t overflows = 0;
  double end = 0;
  std::vector<WakeUpHistogram::Bin> bins;
};

// ln of the share of the tail above y.
template <class T>
T log_above(const T& scale, const T& shape, double y) {
  using std::abs;
  using std::log1p;
  const T x = y / scale;
  // Its series where the quotient has no digits left.
  if (abs(shape) < 1e-5) return -x * (1.0 - 0.5 * shape * x);
  return -log1p(shape * x) / shape;
}

// − ln likelihood of an exceedance, the mean of all. u: ln scale, and the logistic place of the
// shape.
struct TailDeviance {
  const Exceedances& tail;

  template <class T>
  static std::array<T, 2> values(const T* u) {
    using std::exp;
    return {exp(u[0]), kLeastShape + (kMostShape - kLeastShape) / (1.0 + exp(-u[1]))};
  }
  // ln of the shares of the bins and of what is beyond all; false where one is impossible.
  template <class T, class Take>
  bool each(const T* u, const Take& take) const {
    using std::expm1;
    using std::log;
    const std::array<T, 2> found = values(u);
    const T& scale = found[0];
    const T& shape = found[1];
    const auto possible = [&](double y) { return 1.0 + shape * (y / scale) > 0.0; };
    for (const WakeUpHistogram::Bin& bin : tail.bins) {
      if (!possible(bin.from)) return false;
      const T from = log_above(scale, shape, bin.from);
      if (!possible(bin.to)) {
        take(from, bin.count);
      } else {
        take(from + log(-expm1(log_above(scale, shape, bin.to) - from)), bin.count);
      }
    }
    if (tail.overflows == 0) return true;
    if (!possible(tail.end)) return false;
    take(log_above(scale, shape, tail.end), tail.overflows);
    return true;
  }
  template <class T>
  bool operator()(const T* u, T* cost) const {
    using std::isfinite;
    *cost = T(0.0);
    const bool possible = each(u, [&](const T& log_share, std::int64_t count) {
      *cost -= log_share * (static_cast<double>(count) / static_cast<double>(tail.count));
    });
    return possible && isfinite(*cost);
  }
};

// What is above the lowest bin from which on at most this share lies.
Exceedances above(const WakeUpHistogram& histogram, double share) {
  Exceedances tail;
  tail.count = tail.overflows = histogram.overflows;
  tail.end = histogram.bins.back().to;
  const auto all = static_cast<double>(histogram.count() + histogram.overflows);
  std::size_t first = histogram.bins.size();
  while (first > 0 &&
         static_cast<double>(tail.count + histogram.bins[first - 1].count) <= share * all) {
    tail.count += histogram.bins[--first].count;
  }
  // A bin without a count has no threshold: the first of the tail has one.
  while (first < histogram.bins.size() && histogram.bins[first].count == 0) ++first;
  tail.from_s = first < histogram.bins.size() ? histogram.bins[first].from : tail.end;
  tail.share = static_cast<double>(tail.count) / all;
  tail.end -= tail.from_s;
  for (std::size_t i = first; i < histogram.bins.size(); ++i) {
    const WakeUpHistogram::Bin& bin = histogram.bins[i];
    if (bin.count > 0) {
      tail.bins.push_back({bin.from - tail.from_s, bin.to - tail.from_s, bin.count});
    }
  }
  // Of those beyond the histogram the longest is often known, and then that all others are shorter.
  const double longest = histogram.longest.value_or(0) - tail.from_s;
  if (tail.overflows > 0 && longest > tail.end) {
    const WakeUpHistogram::Bin& last = histogram.bins.back();
    if (tail.overflows > 1) tail.bins.push_back({tail.end, longest, tail.overflows - 1});
    tail.bins.push_back({longest, longest + (last.to - last.from), 1});
    tail.overflows = 0;
  }
  return tail;
}

bool enough(const Exceedances& tail) {
  return tail.count >= kFewestExceedances && tail.bins.size() >= kFewestTailBins;
}

struct FoundTail {
  std::array<double, 2> u{};
  bool converged = false;
};

FoundTail search_tail(const Exceedances& tail) {
  double mean = 0;
  for (const WakeUpHistogram::Bin& bin : tail.bins) {
    mean += 0.5 * (bin.from + bin.to) * static_cast<double>(bin.count);
  }
  mean += tail.end * static_cast<double>(tail.overflows);
  mean /= static_cast<double>(tail.count);
  // A shape of 0.1, at which every latency is possible.
  constexpr double kShapeAtStart = 0.1;
  constexpr double kPlace = (kShapeAtStart - kLeastShape) / (kMostShape - kLeastShape);
  FoundTail found{{std::log(mean), std::log(kPlace / (1 - kPlace))}};
  const Likeliest most = likeliest<2>(TailDeviance{tail}, found.u.data());
  found.converged = most.usable && most.converged;
  return found;
}

double share_above(const FoundTail& found, double y) {
  const auto [scale, shape] = TailDeviance::values(found.u.data());
  return 1 + shape * y / scale > 0 ? std::exp(log_above(scale, shape, y)) : 0;
}

// Chi-square over bins, of which neighbours are taken together until five are expected.
double probability_of(const Exceedances& tail, const FoundTail& found) {
  constexpr double kExpected = 5;
  const auto all = static_cast<double>(tail.count);
  double sum = 0;
  int groups = 0;
  double from = 0;
  double seen = 0;
  const auto close = [&](double to, double upto) {
    const double expected = all * (share_above(found, from) - upto);
    sum += (seen - expected) * (seen - expected) / expected;
    ++groups;
    from = to;
    seen = 0;
  };
  for (const WakeUpHistogram::Bin& bin : tail.bins) {
    seen += static_cast<double>(bin.count);
    const double upto = share_above(found, bin.to);
    // What is left has to be enough for the last group.
    if (all * (share_above(found, from) - upto) < kExpected || all * upto < kExpected) continue;
    close(bin.to, upto);
  }
  seen += static_cast<double>(tail.overflows);
  if (share_above(found, from) > 0) close(tail.end, 0);
  const int freedom = groups - 3;  // the sum is given, and two parameters
  if (freedom < 1) return 1;
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(freedom), sum));
}

using Jet2 = ceres::Jet<double, 2>;
using TailCovariance = Eigen::Matrix2d;

// The inverse of Σ count·s·sᵀ, s the gradient of a bin's ln share (Berndt, Hall, Hall & Hausman
// 1974).
TailCovariance tail_covariance(const Exceedances& tail, const FoundTail& found) {
  const std::array<Jet2, 2> u{Jet2(found.u[0], 0), Jet2(found.u[1], 1)};
  TailCovariance information = TailCovariance::Zero();
  TailDeviance{tail}.each(u.data(), [&](const Jet2& log_share, std::int64_t count) {
    information += static_cast<double>(count) * log_share.v * log_share.v.transpose();
  });
  return information.inverse();
}

// ln of the time above the threshold that the share `rare` of all latencies exceeds.
Jet2 log_time(const std::array<Jet2, 2>& u, double rare, double share) {
  using std::expm1;
  using std::log;
  const auto [scale, shape] = TailDeviance::values(u.data());
  const double ratio = std::log(share / rare);
  if (std::abs(shape.a) < 1e-5) return log(scale * ratio * (1.0 + 0.5 * shape * ratio));
  return log(scale * expm1(shape * ratio) / shape);
}

void estimate_tail(const Exceedances& tail, const FoundTail& found, Fit& fit) {
  const TailCovariance c = tail_covariance(tail, found);
  const auto add = [&](std::string name, std::string unit, double value, double low, double high) {
    Estimate e{
        .name = std::move(name), .unit = std::move(unit), .value = value, .low = low, .high = high};
    e.identifiable = std::isfinite(low) && std::isfinite(high);
    if (!e.identifiable) e.remedy = "more latencies, in finer bins";
    fit.parameters.push_back(std::move(e));
  };
  const std::array<double, 2> half{kNormal95 * std::sqrt(c(0, 0)), kNormal95 * std::sqrt(c(1, 1))};
  const auto at = [&](std::size_t k, double off) {
    std::array<double, 2> u = found.u;
    u[k] += off;
    return TailDeviance::values(u.data())[k];
  };
  add("tail_scale", "s", at(0, 0), at(0, -half[0]), at(0, half[0]));
  add("tail_shape", "", at(1, 0), at(1, -half[1]), at(1, half[1]));
  constexpr double kEdge = 1e-3;
  const double shape = at(1, 0);
  fit.parameters.back().at_bound = shape < kLeastShape + kEdge || shape > kMostShape - kEdge;
  fit.correlations = Eigen::Matrix2d::Identity();
  fit.correlations(0, 1) = fit.correlations(1, 0) = c(0, 1) / std::sqrt(c(0, 0) * c(1, 1));
  const std::array<Jet2, 2> u{Jet2(found.u[0], 0), Jet2(found.u[1], 1)};
  for (const char* const rare : kRare) {
    const double one_of = std::stod(rare);
    if (one_of > 0.5 * tail.share) continue;
    const Jet2 time = log_time(u, one_of, tail.share);
    const double off = kNormal95 * std::sqrt(time.v.dot(c * time.v));
    add(fmt::format("exceeded_{}", rare), "s", tail.from_s + std::exp(time.a),
        tail.from_s + std::exp(time.a - off), tail.from_s + std::exp(time.a + off));
  }
}

}  // namespace

WakeUpTail fit_tail(const WakeUpHistogram& histogram, std::optional<double> share) {
  if (share && !(*share > 0 && *share <= kLargestShare)) {
    throw InputError("tail_share", fmt::format("expected a share above 0, at most {}, found {}",
                                               kLargestShare, *share));
  }
  if (histogram.count() + histogram.overflows == 0) throw InputError("count: all are zero");
  WakeUpTail result;
  Exceedances tail;
  FoundTail found;
  bool any = false;
  std::vector<double> shares(kShares.begin(), kShares.end());
  if (share) shares = {*share};
  for (const double part : shares) {
    const Exceedances exceedances = above(histogram, part);
    // A coarse histogram has the same threshold for several shares.
    if (!enough(exceedances) || (any && exceedances.count == tail.count)) continue;
    const FoundTail here = search_tail(exceedances);
    if (any && !here.converged) continue;
    tail = exceedances;
    found = here;
    any = true;
    result.probability = probability_of(tail, found);
    if (result.probability > kRefused) break;
  }
  if (!any) {
    const Exceedances least = above(histogram, share.value_or(kShares.front()));
    throw InputError(
        fmt::format("count: {} latencies in {} bins above {:g} us, the longest {:g} % of all; a "
                    "tail needs {} in "
                    "{} bins: more latencies, or a larger tail_share",
                    least.count, least.bins.size(), least.from_s * 1e6,
                    100 * share.value_or(kShares.front()), kFewestExceedances, kFewestTailBins));
  }
  result.from_s = tail.from_s;
  result.share = tail.share;
  result.count = tail.count;
  Fit& fit = result.fit;
  fit.converged = found.converged;
  fit.starts.tried = 1;
  fit.starts.reached = 1;
  estimate_tail(tail, found, fit);
  std::vector<double> differences;
  double squares = 0;
  for (const WakeUpHistogram::Bin& bin : tail.bins) {
    const double seen = static_cast<double>(bin.count) / static_cast<double>(tail.count);
    differences.push_back(seen - (share_above(found, bin.from) - share_above(found, bin.to)));
    squares += differences.back() * differences.back();
  }
  fit.residual_rms = std::sqrt(squares / static_cast<double>(differences.size()));
  fit.residuals.push_back(std::move(differences));
  const WakeUpHistogram::Bin& longest = tail.bins.back();
  const double expected = share_above(found, longest.from) * static_cast<double>(tail.count);
  constexpr double kUnlikely = 0.01;
  if (tail.overflows == 0 && expected < kUnlikely) {
    fit.warnings.push_back(fmt::format(
        "the longest latency, {:g} us, is none of this tail's: one so long comes once in {:.0f} "
        "such measurements, so that what draws from it has too few of them",
        (result.from_s + longest.from) * 1e6, 1 / expected));
  }
  const auto at_bound = std::ranges::find_if(fit.parameters, &Estimate::at_bound);
  if (at_bound != fit.parameters.end()) {
    fit.warnings.push_back(
        fmt::format("the shape is at the end of its range, {:.2g}, where intervals mean nothing: "
                    "these latencies "
                    "have no such tail, or the threshold is too low",
                    at_bound->value));
  }
  if (result.probability <= kRefused) {
    fit.warnings.push_back(fmt::format(
        "the tail from {:g} us on is no generalised Pareto distribution (chi-square, {:.2g}): what "
        "it says beyond the longest latency is not to be trusted",
        result.from_s * 1e6, result.probability));
  }
  return result;
}

}  // namespace hvp::fit
