#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fit/tissue_problem.h"

namespace hvp::fit {
namespace {

constexpr std::size_t kFewestSamples = 20;
// A step of time may differ by this from the mean: what a clock of microseconds writes at 1 kHz
// and more.
constexpr double kUneven = 0.01;
// Beyond a tenth of the body a displacement is beyond linear theory (docs/finite-elements.md).
constexpr double kLinearShare = 0.1;

double largest(const std::vector<double>& x) {
  double most = 0;
  for (const double value : x) most = std::max(most, std::abs(value));
  return most;
}

void expect_numbers(const std::vector<double>& column, std::size_t size, const std::string& name,
                    const char* what) {
  if (column.size() != size) {
    throw InputError(fmt::format("{}: {} has {} samples and time_s {}; expected as many", name,
                                 what, column.size(), size));
  }
  for (std::size_t i = 0; i < size; ++i) {
    if (!std::isfinite(column[i])) {
      throw InputError(
          fmt::format("{}: {} is {} in sample {}; expected numbers", name, what, column[i], i));
    }
  }
}

void expect_change(const std::vector<double>& column, const std::string& name, const char* what,
                   const char* expected) {
  const auto [low, high] = std::ranges::minmax(column);
  if (low == high) {
    throw InputError(
        fmt::format("{}: {} is {:.4g} throughout; expected {}", name, what, low, expected));
  }
}

void expect_even_time(const TissueBody& body, const TissueLog& log, const std::string& name) {
  const std::size_t n = log.time.size();
  const double mean = (log.time.back() - log.time.front()) / static_cast<double>(n - 1);
  for (std::size_t i = 1; i < n; ++i) {
    const double step = log.time[i] - log.time[i - 1];
    if (!(step > 0)) {
      throw InputError(
          fmt::format("{}: time_s goes from {:.6g} to {:.6g} s in sample {}; "
                      "expected ascending times",
                      name, log.time[i - 1], log.time[i], i));
    }
    if (std::abs(step - mean) > kUneven * mean) {
      throw InputError(
          fmt::format("{}: time_s steps by {:.4g} s in sample {} and by {:.4g} s on "
                      "average; expected evenly spaced times",
                      name, step, i, mean));
    }
  }
  if (body.dynamics && std::abs(mean - body.period_s) > 1e-3 * body.period_s) {
    throw InputError(fmt::format(
        "{}: time_s steps by {:.6g} s and the body's time step is {:.6g} s; expected a log at the "
        "servo period, of which every frame is a sample",
        name, mean, body.period_s));
  }
}

double width(const TissueBody& body) {
  Eigen::Vector3d low = body.mesh.nodes.front();
  Eigen::Vector3d high = low;
  for (const Eigen::Vector3d& node : body.mesh.nodes) {
    low = low.cwiseMin(node);
    high = high.cwiseMax(node);
  }
  return (high - low).maxCoeff();
}

void expect_small(const TissueBody& body, const TissueLog& log, const std::string& name,
                  std::vector<std::string>& warnings) {
  const double way = largest(log.displacement);
  const double across = width(body);
  if (way > across) {
    throw InputError(
        fmt::format("{}: the displacement reaches {:.4g} m and the body is {:.4g} m "
                    "across; expected metres along the direction of the contact",
                    name, way, across));
  }
  if (way > kLinearShare * across) {
    warnings.push_back(fmt::format(
        "{}: the displacement reaches {:.3g} m, more than a tenth of the body's {:.3g} m: what "
        "holds there is not linear elasticity, and E is one of this depth",
        name, way, across));
  }
  if (body.dynamics && std::abs(log.displacement.front()) > 0.05 * way) {
    warnings.push_back(fmt::format(
        "{}: the first displacement is {:.3g} m already: taken as a blow within one period to a "
        "body at rest; let the log begin before the touch",
        name, log.displacement.front()));
  }
}

}  // namespace

TissueLog checked_log(const TissueBody& body, TissueLog log, const std::string& name,
                      std::vector<std::string>& warnings) {
  if (log.time.size() < kFewestSamples) {
    throw InputError(
        fmt::format("{}: {} samples; expected {} or more", name, log.time.size(), kFewestSamples));
  }
  expect_numbers(log.time, log.time.size(), name, "time_s");
  expect_numbers(log.displacement, log.time.size(), name, "the displacement");
  expect_numbers(log.force, log.time.size(), name, "force_N");
  expect_even_time(body, log, name);
  expect_change(log.displacement, name, "the displacement", "a contact that moves");
  expect_change(log.force, name, "force_N", "a force that changes with the displacement");
  expect_small(body, log, name, warnings);
  const double work =
      std::inner_product(log.force.begin(), log.force.end(), log.displacement.begin(), 0.0);
  if (work < 0) {
    for (double& newton : log.force) newton = -newton;
    warnings.push_back(name +
                       ": force_N has the sign of the force on the hand; it is turned round");
  }
  return log;
}

}  // namespace hvp::fit
