#include "models/fit/search.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <ceres/iteration_callback.h>
#include <ceres/manifold.h>
#include <ceres/solver.h>
#include <glog/logging.h>

namespace hvp::fit {

namespace {

// The tolerance for a point of a profile, whose sum of squares is needed to a hundredth of its
// rise.
constexpr int kRoughIterations = 30;
constexpr double kRoughTolerance = 1e-7;

class Report : public ceres::IterationCallback {
 public:
  Report(const Search::Progress& progress, double to_sum) : progress_(progress), to_sum_(to_sum) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (progress_(summary.iteration, summary.cost * to_sum_)) return ceres::SOLVER_CONTINUE;
    stopped = true;
    return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }
  bool stopped = false;

 private:
  const Search::Progress& progress_;
  double to_sum_;
};

// A start at which the model has no value counts as tried, and prints no line on standard error.
void silence_ceres() { FLAGS_minloglevel = google::GLOG_FATAL; }

// A logarithm of zero bounds nothing.
bool bounds(double limit) { return std::isfinite(limit); }

}  // namespace

Search::Search(const Problem& problem, const Coordinates& coordinates, Range range, RobustLoss loss,
               Progress progress)
    : coordinates_(coordinates),
      range_(std::move(range)),
      progress_(std::move(progress)),
      z_(coordinates.size(), 0.0) {
  silence_ceres();
  own_.resize(problem.stretches());
  problem_.AddParameterBlock(z_.data(), static_cast<int>(z_.size()));
  for (std::size_t k = 0; k < z_.size(); ++k) {
    const auto index = static_cast<int>(k);
    if (bounds(coordinates.low(k))) {
      problem_.SetParameterLowerBound(z_.data(), index, coordinates.low(k));
    }
    if (bounds(coordinates.high(k))) {
      problem_.SetParameterUpperBound(z_.data(), index, coordinates.high(k));
    }
  }
  for (std::size_t s = 0; s < own_.size(); ++s) {
    own_[s] = problem.stretch(s).own;
    if (range_.rows[s] == 0) continue;
    auto cost = std::make_unique<StretchCost>(problem.cost(s), problem.weights(s), coordinates,
                                              range_.rows[s], range_.scale, loss);
    std::vector<double*> blocks{z_.data()};
    if (!own_[s].empty()) blocks.push_back(own_[s].data());
    problem_.AddResidualBlock(cost.release(), nullptr, blocks);
  }
}

int Search::residuals() const { return std::accumulate(range_.rows.begin(), range_.rows.end(), 0); }

void Search::put(const Point& at) {
  for (std::size_t k = 0; k < z_.size(); ++k) {
    z_[k] = std::clamp(at.z[k], coordinates_.low(k), coordinates_.high(k));
  }
  for (std::size_t s = 0; s < own_.size(); ++s) {
    std::copy(at.own[s].begin(), at.own[s].end(), own_[s].begin());
  }
}

std::optional<double> Search::sum(const Point& at) {
  put(at);
  double cost = 0;
  if (!problem_.Evaluate({}, &cost, nullptr, nullptr, nullptr)) return std::nullopt;
  return 2 * cost * range_.scale * range_.scale;
}

Optimum Search::solve() {
  ceres::Solver::Options options;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = range_.most_iterations;
  // The residuals are of any size and so are the coordinates: only relative changes mean something.
  options.function_tolerance = range_.tolerance;
  options.parameter_tolerance = 1e-12;
  if (rough_) {
    options.max_num_iterations = std::min(options.max_num_iterations, kRoughIterations);
    options.function_tolerance = std::max(range_.tolerance, kRoughTolerance);
  }
  options.gradient_tolerance = 0;
  options.max_num_consecutive_invalid_steps = 20;
  options.num_threads = 1;
  options.linear_solver_type = ceres::DENSE_QR;
  const auto has_own = [this](std::size_t s) { return range_.rows[s] > 0 && !own_[s].empty(); };
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (std::size_t s = 0; s < own_.size(); ++s) {
    if (!has_own(s)) continue;
    ordering->AddElementToGroup(own_[s].data(), 0);
    options.linear_solver_type = ceres::DENSE_SCHUR;
  }
  if (options.linear_solver_type == ceres::DENSE_SCHUR) {
    ordering->AddElementToGroup(z_.data(), 1);
    options.linear_solver_ordering = ordering;
  }
  const double to_sum = 2 * range_.scale * range_.scale;
  Report report(progress_, to_sum);
  if (progress_) options.callbacks.push_back(&report);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem_, &summary);
  const bool found = summary.IsSolutionUsable() && std::isfinite(summary.final_cost);
  return {{z_, own_},
          summary.final_cost * to_sum,
          found,
          summary.termination_type == ceres::CONVERGENCE,
          report.stopped};
}

// Near a bound the trust region shrinks to almost nothing: coordinates that have reached a bound
// are fixed there, and the search goes on with the others.
Optimum Search::from(const Point& start) {
  put(start);
  Optimum optimum = solve();
  std::vector<int> held;
  for (std::size_t k = 0; k < z_.size(); ++k) {
    if (z_[k] <= coordinates_.low(k) || z_[k] >= coordinates_.high(k)) {
      held.push_back(static_cast<int>(k));
    }
  }
  if (!optimum.found || optimum.interrupted || held.empty() || held.size() == z_.size()) {
    return optimum;
  }
  Optimum next = solve_with(held);
  return next.found && next.sum <= optimum.sum ? next : optimum;
}

Optimum Search::with(std::size_t held, const Point& start) {
  put(start);
  if (z_.size() == 1) return own_alone(start);
  rough_ = true;
  Optimum optimum = solve_with({static_cast<int>(held)});
  rough_ = false;
  return optimum;
}

Optimum Search::solve_with(const std::vector<int>& held) {
  problem_.SetManifold(z_.data(), new ceres::SubsetManifold(static_cast<int>(z_.size()), held));
  Optimum optimum = solve();
  problem_.SetManifold(z_.data(), nullptr);
  return optimum;
}

Optimum Search::own_alone(const Point& start) {
  put(start);
  problem_.SetParameterBlockConstant(z_.data());
  Optimum optimum = solve();
  problem_.SetParameterBlockVariable(z_.data());
  return optimum;
}

}  // namespace hvp::fit
