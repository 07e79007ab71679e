#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "models/fit/fit.h"

namespace hvp::fit {

namespace {

constexpr double kUnexplained = 0.3;  // of the signal

// A robust rms: 1.4826 times the median of |r|.
double without_outliers(const Fit& fit) {
  std::vector<double> sizes;
  for (const std::vector<double>& stretch : fit.residuals) {
    for (const double r : stretch) sizes.push_back(std::abs(r));
  }
  if (sizes.empty()) return 0;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return 1.4826 * *middle;
}

}  // namespace

std::vector<std::string> warnings_of(const Fit& fit, const Problem& problem,
                                     const Options& options) {
  std::vector<std::string> w;
  if (fit.interrupted) {
    w.emplace_back(
        "stopped before the end: the best values so far, and no interval means anything");
  } else if (!fit.converged) {
    w.push_back(
        fmt::format("not converged in {} iterations: values are the best so far, and no "
                    "interval means anything",
                    options.most_iterations));
  }
  const int elsewhere = fit.starts.tried - fit.starts.reached;
  if (elsewhere > 0) {
    w.push_back(fmt::format("{} of {} starts ended elsewhere{}", elsewhere, fit.starts.tried,
                            fit.starts.others.empty()
                                ? std::string()
                                : fmt::format(", with {:.4g} {} rms and more",
                                              fit.starts.others.front().rms, problem.unit())));
  }
  for (const Estimate& e : fit.parameters) {
    if (e.at_bound && !e.fixed) {
      const auto p = std::find_if(problem.parameters().begin(), problem.parameters().end(),
                                  [&](const Parameter& q) { return q.name == e.name; });
      w.push_back(
          fmt::format("{} is at its bound, {:g} {}: {}", e.name, e.value, e.unit, p->because));
    }
    if (!e.identifiable && fit.converged && !fit.interrupted) {
      w.push_back(fmt::format("this log does not give {}: {}", e.name, e.remedy));
    }
  }
  const double signal = problem.signal_rms();
  const double left = options.loss == Loss::squares ? fit.residual_rms : without_outliers(fit);
  if (signal > 0 && left > kUnexplained * signal) {
    w.push_back(fmt::format("the model does not explain the log: {:.0f} % of it is left over",
                            100 * left / signal));
  }
  if (!fit.whiteness.white()) {
    w.push_back(
        fmt::format("neighbouring residuals are alike (Ljung-Box, {} lags, p = {:.1e}): "
                    "intervals are up to {:.2g} times those of white noise",
                    fit.whiteness.lags, fit.whiteness.probability, fit.widened));
  }
  return w;
}

}  // namespace hvp::fit
