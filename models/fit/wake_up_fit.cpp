#include "models/fit/wake_up_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <ceres/jet.h>
#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fit/likelihood.h"
#include "models/fit/wake_up_histogram.h"
#include "models/fit/wake_up_mass.h"

namespace hvp::fit {

namespace {

using Kind = random::TimeDistribution::Kind;

constexpr double kWidestSpread = 1000;  // as [host.wake_up] declares it
constexpr double kAtBound = 20;         // |u|: within 2e-9 of it

std::size_t parameters_of(Kind kind) { return kind == Kind::exponential ? 1 : 2; }

// The searched variables have no bounds: each is a parameter's place between the bounds of
// [host.wake_up], through the logistic function; the lognormal's and the scales' in their
// logarithm.
struct Place {
  double low;
  double high;
  bool logarithmic;

  template <class T>
  T value(const T& u) const {
    using std::exp;
    const T share = 1.0 / (1.0 + exp(-u));
    if (!logarithmic) return low + (high - low) * share;
    return low * exp(std::log(high / low) * share);
  }
  double inverse(double value) const {
    const double share =
        logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
    const double inside = std::clamp(share, 1e-3, 1 - 1e-3);
    return std::log(inside / (1 - inside));
  }
};

std::array<Place, 2> places(Kind kind, const WakeUpCounts& counts) {
  const double width = counts.maximum - counts.minimum;
  const Place scale{1e-4 * counts.finest, width, true};
  if (kind == Kind::exponential) return {scale, scale};
  if (kind == Kind::normal) return {Place{counts.minimum, counts.maximum, false}, scale};
  const double lowest = std::max(counts.minimum, 1e-3 * counts.finest);
  // If half of the range is within the spread, so is one of the two bounds, whatever the median.
  double widest = std::log(kWidestSpread);
  if (counts.minimum > 0) {
    widest = std::min(widest, 0.499 * std::log(counts.maximum / counts.minimum));
  }
  return {Place{lowest, counts.maximum, true}, Place{1e-3 * widest, widest, true}};
}

// − ln likelihood of a latency, the mean of all.
struct Deviance {
  Kind kind;
  const WakeUpCounts& counts;
  std::array<Place, 2> at;

  template <class T>
  std::array<T, 2> values(const T* u) const {
    return {at[0].value(u[0]), parameters_of(kind) > 1 ? at[1].value(u[1]) : T(0.0)};
  }
  // The logarithm of a bin's share of the times that are not cut off.
  template <class T>
  T log_share(const std::array<T, 2>& p, const WakeUpHistogram::Bin& bin) const {
    return log_mass(kind, counts.minimum, p.data(), bin.from, bin.to) -
           log_mass(kind, counts.minimum, p.data(), counts.minimum, counts.maximum);
  }
  template <class T>
  bool operator()(const T* u, T* cost) const {
    using std::isfinite;
    const std::array<T, 2> p = values(u);
    const T all = log_mass(kind, counts.minimum, p.data(), counts.minimum, counts.maximum);
    *cost = all;
    for (const WakeUpHistogram::Bin& bin : counts.bins) {
      const T share = log_mass(kind, counts.minimum, p.data(), bin.from, bin.to);
      *cost -= share * (static_cast<double>(bin.count) / static_cast<double>(counts.total));
    }
    return isfinite(*cost);
  }
};

// The distribution found by maximum likelihood.
struct Found {
  Kind kind = Kind::exponential;
  std::array<double, 2> u{};
  std::array<double, 2> value{};
  double log_likelihood = -std::numeric_limits<double>::infinity();
  bool converged = false;

  double aic() const { return 2 * static_cast<double>(parameters_of(kind)) - 2 * log_likelihood; }
};

std::array<double, 2> start(Kind kind, const WakeUpCounts& counts) {
  double mean = 0;
  double log_mean = 0;
  double squares = 0;
  double log_squares = 0;
  for (const WakeUpHistogram::Bin& bin : counts.bins) {
    const double share = static_cast<double>(bin.count) / static_cast<double>(counts.total);
    const double middle = 0.5 * (bin.from + bin.to);
    mean += share * middle;
    squares += share * middle * middle;
    log_mean += share * std::log(middle);
    log_squares += share * std::log(middle) * std::log(middle);
  }
  const double deviation = std::sqrt(std::max(0.0, squares - mean * mean));
  if (kind == Kind::exponential) return {mean - counts.minimum, 0};
  if (kind == Kind::normal) return {mean, deviation};
  return {std::exp(log_mean), std::sqrt(std::max(0.0, log_squares - log_mean * log_mean))};
}

template <int Count>
Found search(const Deviance& deviance) {
  const std::array<double, 2> first = start(deviance.kind, deviance.counts);
  Found found{.kind = deviance.kind, .u = {deviance.at[0].inverse(first[0]), 0}, .value = {}};
  if (Count > 1) found.u[1] = deviance.at[1].inverse(first[1]);
  const Likeliest most = likeliest<Count>(deviance, found.u.data());
  if (!most.usable) return found;
  found.converged = most.converged;
  found.value = deviance.values(found.u.data());
  found.log_likelihood = -most.cost * static_cast<double>(deviance.counts.total);
  return found;
}

random::TimeDistribution distribution_of(const Found& found, const WakeUpCounts& counts) {
  random::TimeDistribution d;
  d.kind = found.kind;
  d.minimum_s = counts.minimum;
  d.maximum_s = counts.maximum;
  if (found.kind == Kind::lognormal) {
    d.median_s = found.value[0];
    d.spread = std::exp(found.value[1]);
  } else {
    d.mean_s = found.value[0];
    if (found.kind == Kind::normal) d.deviation_s = found.value[1];
  }
  return d;
}

// Covariance of u: the inverse of Σ count·s·sᵀ, s the gradient of a bin's ln share (Berndt, Hall,
// Hall & Hausman 1974).
template <int Count>
Eigen::Matrix<double, Count, Count> covariance(const Deviance& deviance, const Found& found) {
  using FitJet = ceres::Jet<double, Count>;
  std::array<FitJet, 2> u{};
  for (std::size_t k = 0; k < Count; ++k) u[k] = FitJet(found.u[k], static_cast<int>(k));
  const std::array<FitJet, 2> p = deviance.values(u.data());
  Eigen::Matrix<double, Count, Count> information;
  information.setZero();
  for (const WakeUpHistogram::Bin& bin : deviance.counts.bins) {
    const FitJet share = deviance.log_share(p, bin);
    information += static_cast<double>(bin.count) * share.v * share.v.transpose();
  }
  return information.inverse();
}

template <int Count>
void estimate(const Deviance& deviance, const Found& found, Fit& fit) {
  const Eigen::Matrix<double, Count, Count> c = covariance<Count>(deviance, found);
  const bool lognormal = found.kind == Kind::lognormal;
  const std::array<const char*, 2> names{lognormal ? "median" : "mean",
                                         lognormal ? "spread" : "deviation"};
  for (std::size_t k = 0; k < Count; ++k) {
    const auto index = static_cast<Eigen::Index>(k);
    const double half = kNormal95 * std::sqrt(c(index, index));
    const bool known = std::isfinite(half);
    const auto shown = [&](double u) {
      const double value = deviance.at[k].value(u);
      return lognormal && k == 1 ? std::exp(value) : value;
    };
    const double reach = known ? half : 2 * kAtBound;
    fit.parameters.push_back({.name = names[k],
                              .unit = lognormal && k == 1 ? "" : "s",
                              .value = shown(found.u[k]),
                              .low = shown(found.u[k] - reach),
                              .high = shown(found.u[k] + reach),
                              .identifiable = known,
                              .at_bound = std::abs(found.u[k]) > kAtBound,
                              .remedy = known ? "" : "more latencies, in finer bins"});
  }
  fit.correlations = Eigen::MatrixXd::Identity(Count, Count);
  if (Count > 1) {
    fit.correlations(0, Count - 1) = fit.correlations(Count - 1, 0) =
        c(0, Count - 1) / std::sqrt(c(0, 0) * c(Count - 1, Count - 1));
  }
}

void add_bounds(const WakeUpCounts& counts, Fit& fit) {
  for (const auto& [name, value] :
       {std::pair{"minimum", counts.minimum}, std::pair{"maximum", counts.maximum}}) {
    fit.parameters.push_back(
        {.name = name, .unit = "s", .value = value, .low = value, .high = value, .fixed = true});
  }
}

}  // namespace

WakeUpFit fit_wake_up(const WakeUpHistogram& histogram) {
  const WakeUpCounts counts = wake_up_counts(histogram);
  std::vector<Found> all;
  for (const Kind kind : {Kind::exponential, Kind::normal, Kind::lognormal}) {
    const Deviance deviance{kind, counts, places(kind, counts)};
    all.push_back(parameters_of(kind) == 1 ? search<1>(deviance) : search<2>(deviance));
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Found& a, const Found& b) { return a.aic() < b.aic(); });
  const Found& best = all.front();
  if (!std::isfinite(best.log_likelihood)) {
    throw InputError("count: none of the distributions has a likelihood of this histogram");
  }
  WakeUpFit result;
  for (const Found& found : all) {
    if (!std::isfinite(found.log_likelihood)) continue;
    result.candidates.push_back(
        {distribution_of(found, counts), found.log_likelihood, found.aic()});
  }
  result.distribution = result.candidates.front().distribution;
  const Deviance deviance{best.kind, counts, places(best.kind, counts)};
  if (parameters_of(best.kind) == 1) {
    estimate<1>(deviance, best, result.fit);
  } else {
    estimate<2>(deviance, best, result.fit);
  }
  add_bounds(counts, result.fit);
  result.fit.converged = best.converged;
  result.fit.starts.tried = 1;
  result.fit.starts.reached = 1;

  std::vector<double> differences;
  double squares = 0;
  for (const WakeUpHistogram::Bin& bin : counts.bins) {
    const double share = static_cast<double>(bin.count) / static_cast<double>(counts.total);
    differences.push_back(share - std::exp(deviance.log_share(best.value, bin)));
    squares += differences.back() * differences.back();
  }
  result.fit.residual_rms = std::sqrt(squares / static_cast<double>(differences.size()));
  result.fit.residuals.push_back(std::move(differences));
  result.tail = tail_of(counts, result.distribution);
  result.fit.warnings = wake_up_warnings(histogram, counts, result);
  return result;
}

}  // namespace hvp::fit
