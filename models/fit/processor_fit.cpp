#include "models/fit/processor_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <ceres/ceres.h>
#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::fit {

namespace {

constexpr int kLeastTimes = 8;

// The logarithms of a processor's figures, which any number may be.
constexpr int kFigures = 10;
using Figures = std::array<double, kFigures>;
// Of the last cache also the size: other cores, and other users of the machine, fill it too.
constexpr std::size_t kLastCache = kFigures - 1;

std::array<double host::Processor::*, 6> single_figures() {
  using host::Processor;
  return {&Processor::call_s,       &Processor::dense_flops,      &Processor::single_flops,
          &Processor::sparse_flops, &Processor::triangular_flops, &Processor::memory_bandwidth};
}

// Operations a second of one core: twice 8 doubles a clock of 5 GHz with two units, twice that in
// single precision, and what is gathered or waited for by tens of gigabytes.
constexpr std::array<double, 5> kMostRates = {0, 200e9, 400e9, 50e9, 50e9};

// No call takes less, and its logarithm is a number.
constexpr double kLeastCall = 1e-9;

Figures figures_of(const host::Processor& p) {
  Figures z{};
  const auto single = single_figures();
  for (std::size_t i = 0; i < single.size(); ++i) {
    z[i] = std::log(std::max(p.*single[i], i == 0 ? kLeastCall : 1.0));
    if (i > 0 && i < kMostRates.size()) z[i] = std::min(z[i], std::log(kMostRates[i]));
  }
  for (std::size_t i = 0; i < p.caches.size(); ++i) {
    z[single.size() + i] = std::log(p.caches[i].bandwidth);
  }
  z[kLastCache] = std::log(p.caches.back().size_bytes);
  return z;
}

host::Processor with_figures(host::Processor p, const double* z) {
  const auto single = single_figures();
  for (std::size_t i = 0; i < single.size(); ++i) p.*single[i] = std::exp(z[i]);
  for (std::size_t i = 0; i < p.caches.size(); ++i) {
    p.caches[i].bandwidth = std::exp(z[single.size() + i]);
  }
  p.caches.back().size_bytes = std::exp(z[kLastCache]);
  return p;
}

// ln(predicted / measured) of one solve.
struct LogRatio {
  const SolveTime* time;
  const host::Processor* caches;
  bool operator()(const double* z, double* residual) const {
    const host::Processor p = with_figures(*caches, z);
    residual[0] = std::log(p.seconds(time->work, time->working_set) / time->seconds);
    return std::isfinite(residual[0]);
  }
};

// A weak pull to where the search began, for figures that no time tells apart.
struct Pull {
  Figures start;
  bool operator()(const double* z, double* residual) const {
    for (std::size_t i = 0; i < start.size(); ++i) residual[i] = 1e-2 * (z[i] - start[i]);
    return true;
  }
};

struct Searched {
  Figures z{};
  double cost = 0;
};

Searched search(const std::vector<SolveTime>& times, const host::Processor& from,
                const host::Processor& start) {
  const Figures begin = figures_of(from);
  Searched found{begin};
  Figures& z = found.z;
  ceres::Problem problem;
  for (const SolveTime& time : times) {
    if (time.held_out) continue;
    // A time that something disturbed, or that the model does not explain, does not bend the
    // others.
    problem.AddResidualBlock(
        new ceres::NumericDiffCostFunction<LogRatio, ceres::CENTRAL, 1, kFigures>(
            new LogRatio{&time, &start}),
        new ceres::CauchyLoss(0.15), z.data());
  }
  problem.AddResidualBlock(
      new ceres::NumericDiffCostFunction<Pull, ceres::CENTRAL, kFigures, kFigures>(new Pull{begin}),
      nullptr, z.data());
  // Where the bytes take all of the time, any rate would do: no core of today has more.
  for (std::size_t i = 1; i < kMostRates.size(); ++i) {
    problem.SetParameterUpperBound(z.data(), static_cast<int>(i), std::log(kMostRates[i]));
  }
  problem.SetParameterUpperBound(z.data(), kLastCache,
                                 std::log(std::max(start.caches.back().size_bytes, 1.0)));
  problem.SetParameterLowerBound(z.data(), kLastCache,
                                 std::log(std::max(start.caches[1].size_bytes, 1.0)));
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 500;
  options.function_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  found.cost = summary.final_cost;
  return found;
}

}  // namespace

ProcessorFit fit_processor(const std::vector<SolveTime>& times, const host::Processor& start) {
  const auto fitted = std::ranges::count_if(times, [](const auto& t) { return !t.held_out; });
  if (fitted < kLeastTimes) {
    throw InputError(
        fmt::format("expected at least {} times of solves to fit, found {}", kLeastTimes, fitted));
  }
  for (const SolveTime& time : times) {
    if (time.seconds > 0 && time.work.operations() > 0) continue;
    throw InputError(fmt::format("{} of {} unknowns: expected a time above zero, found {:g} s",
                                 time.solver, time.unknowns, time.seconds));
  }
  // How much room the last cache has is found from several places: between two sizes of solves the
  // sum of squares does not change.
  std::optional<Searched> best;
  for (const double share : {1.0, 0.6, 0.35, 0.2}) {
    host::Processor from = start;
    from.caches.back().size_bytes =
        std::max(start.caches[1].size_bytes, share * start.caches.back().size_bytes);
    const Searched found = search(times, from, start);
    if (!best || found.cost < best->cost) best = found;
  }
  ProcessorFit result;
  result.processor = with_figures(start, best->z.data());
  for (const SolveTime& time : times) {
    const double seconds = result.processor.seconds(time.work, time.working_set);
    const double ratio = seconds / time.seconds;
    result.predictions.push_back({seconds, ratio});
    double& worst = time.held_out ? result.worst_held_out : result.worst_fitted;
    worst = std::max({worst, ratio, 1 / ratio});
  }
  return result;
}

}  // namespace hvp::fit
