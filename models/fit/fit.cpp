#include "models/fit/fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fit/search.h"
#include "models/fit/uncertainty.h"
#include "models/random/draws.h"

namespace hvp::fit {

namespace {

constexpr std::size_t kStretchesToHoldOut = 5;
// Optima whose sums of squares differ by less than this many residual variances, half a degree of
// freedom, count as the same.
constexpr double kSameOptimum = 0.5;
// Residuals below this share of those at the first start are those of a log without noise.
constexpr double kExact = 1e-6;
constexpr double kDecade = 10;
constexpr double kHopeless = 3;

int total(const std::vector<int>& rows) { return std::accumulate(rows.begin(), rows.end(), 0); }

double root_mean(double sum, int count) { return count > 0 ? std::sqrt(sum / count) : 0; }

class Fitting {
 public:
  Fitting(const Problem& problem, const Options& options);
  Fit run();

 private:
  Search::Progress watch();
  Search::Range range_of(const std::vector<int>& rows) const {
    return {rows, scale_, options_.most_iterations, options_.tolerance};
  }
  Point start(int attempt) const;
  Point bare(std::vector<double> z) const;
  Optimum search_from_all(Search& search);
  Optimum refine_robustly(Optimum best);
  void hold_out(const Optimum& best);
  void estimate(const Optimum& best);
  void keep_residuals(const Optimum& best);
  double residual_rms_at(const Point& at) const;
  double robust_scale(const Optimum& at) const;

  const Problem& problem_;
  const Options& options_;
  Coordinates coordinates_;
  std::vector<int> rows_;
  std::vector<std::vector<double>> own_;
  double scale_ = 1;
  RobustLoss loss_;
  int attempt_ = 1;
  Fit fit_;
};

Fitting::Fitting(const Problem& problem, const Options& options)
    : problem_(problem), options_(options), coordinates_(problem.parameters(), options.fixed) {
  int own = 0;
  for (std::size_t s = 0; s < problem.stretches(); ++s) {
    const Problem::Stretch stretch = problem.stretch(s);
    rows_.push_back(static_cast<int>(stretch.residuals));
    own += static_cast<int>(stretch.own.size());
    own_.push_back(stretch.own);
  }
  const int unknowns = static_cast<int>(coordinates_.size()) + own;
  if (total(rows_) <= unknowns) {
    throw InputError(
        fmt::format("{} samples for {} unknowns: expected more", total(rows_), unknowns));
  }
}

Point Fitting::bare(std::vector<double> z) const { return {std::move(z), own_}; }

// Every search reports its progress, those for intervals too, so that the caller can end any of
// them.
Search::Progress Fitting::watch() {
  if (!options_.progress) return {};
  return [this](int iteration, double sum) {
    if (fit_.interrupted) return false;
    const int starts = std::max(1, options_.starts);
    fit_.interrupted = !options_.progress(
        {std::min(attempt_, starts), starts, iteration, root_mean(sum, total(rows_))});
    return !fit_.interrupted;
  };
}

Point Fitting::start(int attempt) const {
  std::vector<double> z;
  const random::Draws draws(static_cast<std::int64_t>(options_.seed), "fit.start");
  for (std::size_t k = 0; k < coordinates_.size(); ++k) {
    const Parameter& p = coordinates_[k];
    double at = coordinates_.inner(k, std::clamp(p.start, p.low, p.high));
    if (attempt > 1) {
      const double low = coordinates_.inner(k, p.draw_low);
      const double high = coordinates_.inner(k, p.draw_high);
      at = low + draws.uniform(attempt, static_cast<std::uint32_t>(k)).first * (high - low);
    }
    z.push_back(at);
  }
  return bare(std::move(z));
}

Optimum Fitting::search_from_all(Search& search) {
  std::vector<Optimum> found;
  fit_.starts.tried = 0;
  for (attempt_ = 1; attempt_ <= std::max(1, options_.starts); ++attempt_) {
    Optimum optimum = search.from(start(attempt_));
    ++fit_.starts.tried;
    const bool stopped = optimum.interrupted;
    if (optimum.found) found.push_back(std::move(optimum));
    if (!stopped) continue;
    fit_.interrupted = true;
    break;
  }
  if (found.empty()) throw InputError("the model has no value at any of the starts");
  std::sort(found.begin(), found.end(),
            [](const Optimum& a, const Optimum& b) { return a.sum < b.sum; });
  const Optimum& best = found.front();
  const double exact = kExact * scale_;
  const double same = best.sum * kSameOptimum / total(rows_) + total(rows_) * exact * exact;
  double last_sum = 0;
  for (const Optimum& o : found) {
    if (o.sum - best.sum <= same) {
      ++fit_.starts.reached;
      continue;
    }
    std::vector<Starts::Other>& others = fit_.starts.others;
    if (!others.empty() && o.sum <= last_sum * (1 + 1e-4)) {
      ++others.back().times;
      continue;
    }
    last_sum = o.sum;
    others.push_back({residual_rms_at(o.at), coordinates_.values(o.at.z.data()), 1});
  }
  return best;
}

// 1.4826 times the median of |r|: the standard deviation of normal noise beside the outliers.
double Fitting::robust_scale(const Optimum& at) const {
  const Linear linear = linearise(problem_, coordinates_, rows_, at.at, {});
  std::vector<double> sizes;
  for (const Eigen::VectorXd& r : linear.weighted) {
    for (const double value : r) sizes.push_back(std::abs(value));
  }
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return 1.4826 * *middle;
}

// Its scale from the residuals until it is settled: the first ones are those of least squares. With
// a fifth of outliers that takes some. The constants keep 95 % of the efficiency for normal noise
// (Huber 1981; Holland & Welsch 1977).
Optimum Fitting::refine_robustly(Optimum best) {
  const double constant = options_.loss == Loss::huber ? 1.345 : 2.385;
  constexpr int kMost = 50;
  constexpr double kSettled = 1e-4;
  double before = 0;
  for (int i = 0; i < kMost; ++i) {
    const double scale = robust_scale(best);
    if (!(scale > 0) || std::abs(scale - before) <= kSettled * scale) break;
    before = scale;
    loss_ = {options_.loss, constant * scale};
    Search search(problem_, coordinates_, range_of(rows_), loss_, watch());
    Optimum next = search.from(best.at);
    if (!next.found) break;
    next.interrupted = best.interrupted;
    best = std::move(next);
  }
  return best;
}

void Fitting::hold_out(const Optimum& best) {
  if (!(options_.hold_out > 0) || fit_.interrupted) return;
  std::vector<int> fitted = rows_;
  if (rows_.size() >= kStretchesToHoldOut) {
    const auto held =
        static_cast<std::size_t>(std::ceil(options_.hold_out * static_cast<double>(rows_.size())));
    std::fill(fitted.end() - static_cast<std::ptrdiff_t>(std::min(held, rows_.size() - 1)),
              fitted.end(), 0);
  } else {
    for (int& n : fitted) n -= static_cast<int>(std::floor(options_.hold_out * n));
  }
  int own = 0;
  for (std::size_t s = 0; s < own_.size(); ++s) {
    if (fitted[s] > 0) own += static_cast<int>(own_[s].size());
  }
  if (total(fitted) <= static_cast<int>(coordinates_.size()) + own) {
    fit_.warnings.emplace_back("nothing is held out: the rest would be too short to fit");
    return;
  }
  Search search(problem_, coordinates_, range_of(fitted), loss_, watch());
  Optimum rest = search.from(best.at);
  if (!rest.found) return;
  if (rows_.size() >= kStretchesToHoldOut) {
    // The initial state of a stretch is fitted; the rest of it is predicted.
    Search all(problem_, coordinates_, range_of(rows_), loss_, watch());
    rest = all.own_alone(rest.at);
  }
  const Linear linear = linearise(problem_, coordinates_, rows_, rest.at, {});
  double sum = 0;
  int count = 0;
  for (std::size_t s = 0; s < rows_.size(); ++s) {
    const int held = rows_[s] - fitted[s];
    sum += linear.residuals[s].tail(held).squaredNorm();
    count += held;
  }
  if (count > 0) fit_.held_out_rms = root_mean(sum, count);
}

// An interval that is wider than the value, and than what would show, says nothing; nor does one
// of what is known to a factor, over a decade. `times` as wide ones do not count as such.
bool says_something(const Estimate& e, const Parameter& p, double times = 1) {
  if (p.logarithmic && std::log(e.high / e.low) > times * std::log(kDecade)) return false;
  return e.high - e.low <= times * 2 * std::max(std::abs(e.value), p.matters);
}

void Fitting::estimate(const Optimum& best) {
  const Linear linear = linearise(problem_, coordinates_, rows_, best.at, loss_);
  const Uncertainty uncertainty = uncertainty_of(linear);
  fit_.noise_order = static_cast<int>(uncertainty.noise.coefficients.size());
  fit_.widened = uncertainty.widened;
  fit_.whiteness = whiteness_of(linear.weighted);
  const std::vector<double> values = coordinates_.values(best.at.z.data());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Parameter& p = problem_.parameters()[i];
    Estimate e{p.name, p.unit, values[i], values[i], values[i]};
    e.fixed = coordinates_.is_fixed(i);
    fit_.parameters.push_back(std::move(e));
  }
  Search search(problem_, coordinates_, range_of(rows_), loss_, watch());
  Intervals intervals(search, coordinates_, linear, uncertainty, best);
  const auto n = static_cast<Eigen::Index>(coordinates_.size());
  fit_.correlations = Eigen::MatrixXd::Identity(n, n);
  for (std::size_t k = 0; k < coordinates_.size(); ++k) {
    const Parameter& p = coordinates_[k];
    Estimate& e = fit_.parameters[coordinates_.parameter(k)];
    e.at_bound = best.at.z[k] <= coordinates_.low(k) || best.at.z[k] >= coordinates_.high(k);
    if (uncertainty.singular[k]) {
      e.low = p.low;
      e.high = p.high;
      e.identifiable = false;
    } else {
      Interval interval = intervals.plain(k);
      const auto put = [&] {
        e.low = std::clamp(coordinates_.outer(k, interval.low), p.low, e.value);
        e.high = std::clamp(coordinates_.outer(k, interval.high), e.value, p.high);
      };
      put();
      // An interval that is this far from saying something is not profiled.
      if (!fit_.interrupted && says_something(e, p, kHopeless)) {
        interval = intervals.of(k);
        put();
      }
      e.profiled = interval.profiled;
      e.identifiable = says_something(e, p);
    }
    if (!e.identifiable) e.remedy = p.remedy;
    if (!fit_.converged || fit_.interrupted) {
      // An interval around a point that is no optimum says nothing.
      e.identifiable = false;
      e.remedy = "a search that converges";
    }
    for (std::size_t j = 0; j < coordinates_.size(); ++j) {
      const double product = uncertainty.deviation(k) * uncertainty.deviation(j);
      const auto row = static_cast<Eigen::Index>(k);
      const auto column = static_cast<Eigen::Index>(j);
      if (j != k && product > 0) {
        fit_.correlations(row, column) = uncertainty.covariance(row, column) / product;
      }
    }
  }
}

double Fitting::residual_rms_at(const Point& at) const {
  double sum = 0;
  for (const Eigen::VectorXd& r : linearise(problem_, coordinates_, rows_, at, {}).residuals) {
    sum += r.squaredNorm();
  }
  return root_mean(sum, total(rows_));
}

void Fitting::keep_residuals(const Optimum& best) {
  for (const Eigen::VectorXd& r : linearise(problem_, coordinates_, rows_, best.at, {}).residuals) {
    fit_.residuals.emplace_back(r.begin(), r.end());
  }
  fit_.residual_rms = residual_rms_at(best.at);
  fit_.own = best.at.own;
  fit_.converged = best.converged && !best.interrupted;
}

Fit Fitting::run() {
  Search trial(problem_, coordinates_, range_of(rows_), {});
  for (int attempt = 1; attempt <= std::max(1, options_.starts); ++attempt) {
    const std::optional<double> sum = trial.sum(start(attempt));
    if (!sum || !(*sum > 0) || !std::isfinite(*sum)) continue;
    scale_ = root_mean(*sum, total(rows_));
    break;
  }
  Search search(problem_, coordinates_, range_of(rows_), {}, watch());
  Optimum best = search_from_all(search);
  if (options_.loss != Loss::squares) best = refine_robustly(std::move(best));
  keep_residuals(best);
  estimate(best);
  hold_out(best);
  for (std::string& w : warnings_of(fit_, problem_, options_)) {
    fit_.warnings.push_back(std::move(w));
  }
  return std::move(fit_);
}

}  // namespace

Fit fit(const Problem& problem, const Options& options) { return Fitting(problem, options).run(); }

}  // namespace hvp::fit
