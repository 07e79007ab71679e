#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include <ceres/gradient_checker.h>
#include <gtest/gtest.h>

#include "models/fit/device_problem.h"
#include "models/fit/twins.h"

namespace hvp::fit::device_cost_test {
namespace {

std::vector<double> truth(const DeviceTwin& twin, const DeviceLayout& layout) {
  std::vector<double> values(layout.count);
  values[layout.mass] = twin.mass;
  values[layout.damping] = twin.damping;
  values[layout.coulomb] = twin.coulomb;
  values[layout.offset] = twin.offset;
  values[layout.delay] = twin.delay;
  if (layout.motor_constant != DeviceLayout::kNone) {
    values[layout.motor_constant] = twin.motor_constant;
  }
  if (layout.bandwidth != DeviceLayout::kNone) values[layout.bandwidth] = twin.bandwidth;
  return values;
}

DeviceLayout layout_of(const DeviceTwin& twin) {
  return DeviceLayout::of(twin.motor_constant == 1 ? DeviceCommand::force : DeviceCommand::current,
                          twin.bandwidth > 0);
}

std::vector<DeviceTwin> twins() {
  DeviceTwin plain;
  DeviceTwin late = plain;
  late.delay = 2.37e-3;
  DeviceTwin lags = late;
  lags.bandwidth = 80;
  DeviceTwin driven = lags;
  driven.motor_constant = 0.7;
  DeviceTwin fast = lags;  // the lag and the damping are over within a period
  fast.bandwidth = 900;
  fast.damping = 40;
  DeviceTwin sticky = lags;  // stands most of the time
  sticky.coulomb = 0.45;
  DeviceTwin same = lags;  // β = r, where the solution changes its form
  same.damping = same.mass * DeviceTwin::kTwoPi * same.bandwidth;
  DeviceTwin whole = lags;
  whole.delay = 3e-3;
  return {plain, late, lags, driven, fast, sticky, same, whole};
}

// The plant's own integration, exact to the last bits, says where the axis would be.
TEST(FitDeviceCost, TrajectoryIsThePlants) {
  for (const DeviceTwin& twin : twins()) {
    const DeviceLog log = twin.follow(busy_command(2000, twin.period, 1));
    const DeviceLayout layout = layout_of(twin);
    const auto cost = device_cost(log, layout, 0, log.position.size());
    const std::vector<double> values = truth(twin, layout);
    const std::vector<double> own{0, 0};
    std::vector<double> residuals(log.position.size());
    ASSERT_TRUE(cost->Evaluate(std::vector<const double*>{values.data(), own.data()}.data(),
                               residuals.data(), nullptr));
    double largest = 0;
    for (const double r : residuals) largest = std::max(largest, std::abs(r));
    EXPECT_LT(largest, 1e-10) << "delay " << twin.delay << " bandwidth " << twin.bandwidth;
  }
}

// How many samples the axis stands for.
std::size_t standing(const DeviceLog& log) {
  std::size_t n = 0;
  for (std::size_t i = 1; i < log.position.size(); ++i) {
    n += log.position[i] == log.position[i - 1] ? 1U : 0U;
  }
  return n;
}

using Values = std::vector<double>;

Values residuals_at(const ceres::CostFunction& cost, const Values& values, const Values& own) {
  Values residuals(static_cast<std::size_t>(cost.num_residuals()));
  EXPECT_TRUE(cost.Evaluate(std::vector<const double*>{values.data(), own.data()}.data(),
                            residuals.data(), nullptr));
  return residuals;
}

// Against central differences of two steps, extrapolated (Richardson): their error is of the
// fourth order in a step of 1e-4 of the value.
void check_derivatives(const DeviceTwin& twin, const DeviceLog& log, std::size_t first,
                       std::size_t last, double velocity) {
  const DeviceLayout layout = layout_of(twin);
  const auto cost = device_cost(log, layout, first, last);
  Values values = truth(twin, layout);
  Values own{log.position[first], velocity};
  const std::size_t rows = last - first;
  Values residuals(rows), of_values(rows * layout.count), of_own(2 * rows);
  std::vector<double*> jacobians{of_values.data(), of_own.data()};
  ASSERT_TRUE(cost->Evaluate(std::vector<const double*>{values.data(), own.data()}.data(),
                             residuals.data(), jacobians.data()));
  for (std::size_t p = 0; p < layout.count + 2; ++p) {
    double& value = p < layout.count ? values[p] : own[p - layout.count];
    const double kept = value;
    const auto central = [&](double h) {
      value = kept + h;
      Values difference = residuals_at(*cost, values, own);
      value = kept - h;
      const Values before = residuals_at(*cost, values, own);
      value = kept;
      for (std::size_t i = 0; i < rows; ++i) difference[i] = (difference[i] - before[i]) / (2 * h);
      return difference;
    };
    const double h = 1e-4 * std::max(std::abs(kept), 1e-3);
    const Values coarse = central(h);
    const Values fine = central(h / 2);
    double largest = 0;
    double wrong = 0;
    for (std::size_t i = 0; i < rows; ++i) {
      const double expected = (4 * fine[i] - coarse[i]) / 3;
      const double found =
          p < layout.count ? of_values[i * layout.count + p] : of_own[2 * i + p - layout.count];
      largest = std::max(largest, std::abs(expected));
      wrong = std::max(wrong, std::abs(expected - found));
    }
    EXPECT_LE(wrong, 2e-5 * largest + 1e-12)
        << "parameter " << p << " delay " << twin.delay << " bandwidth " << twin.bandwidth
        << " coulomb " << twin.coulomb << " from " << first;
  }
}

TEST(FitDeviceCost, DerivativesAreThoseOfTheMotion) {
  for (const DeviceTwin& twin : twins()) {
    if (twin.delay == 0) continue;  // a smaller one has no value
    const DeviceLog log = twin.follow(busy_command(800, twin.period, 1));
    for (const std::size_t first : {0U, 130U, 300U}) {
      check_derivatives(twin, log, first, first + 120, 0.05);
    }
  }
}

TEST(FitDeviceCost, DerivativesHoldWhereTheAxisSticksAndBreaksLoose) {
  DeviceTwin twin;
  twin.coulomb = 0.45;
  twin.delay = 2.37e-3;
  twin.bandwidth = 80;
  const DeviceLog log = twin.follow(busy_command(800, twin.period, 1));
  ASSERT_GT(standing(log), 200U);
  ASSERT_LT(standing(log), 700U);
  for (const std::size_t first : {0U, 200U, 400U, 600U}) {
    check_derivatives(twin, log, first, first + 200, -0.08);
  }
}

// At a delay of whole samples the boundary between two commands crosses the samples.
TEST(FitDeviceCost, DelayMayCrossASample) {
  DeviceTwin twin;
  twin.delay = 3e-3;
  const DeviceLog log = twin.follow(busy_command(400, twin.period, 1));
  const DeviceLayout layout = layout_of(twin);
  const auto cost = device_cost(log, layout, 0, 300);
  std::vector<double> values = truth(twin, layout);
  const std::vector<double> own{0, 0};
  const auto slopes = [&](double delay) {
    values[layout.delay] = delay;
    std::vector<double> residuals(300), all(300 * layout.count), of_own(600), column(300);
    std::vector<double*> jacobians{all.data(), of_own.data()};
    EXPECT_TRUE(cost->Evaluate(std::vector<const double*>{values.data(), own.data()}.data(),
                               residuals.data(), jacobians.data()));
    for (std::size_t i = 0; i < 300; ++i) column[i] = all[i * layout.count + layout.delay];
    return column;
  };
  const std::vector<double> before = slopes(3e-3 - 1e-12);
  const std::vector<double> at = slopes(3e-3);
  const std::vector<double> behind = slopes(3e-3 + 1e-12);
  double largest = 0;
  for (std::size_t i = 0; i < 300; ++i) {
    largest = std::max(largest, std::abs(at[i]));
    EXPECT_NEAR(before[i], at[i], 1e-7);
    EXPECT_NEAR(behind[i], at[i], 1e-7);
  }
  EXPECT_GT(largest, 0.01);
}

TEST(FitDeviceCost, HasNoValueForWhatIsNoAxis) {
  const DeviceTwin twin;
  const DeviceLog log = twin.follow(busy_command(100, twin.period, 1));
  const DeviceLayout layout = layout_of(twin);
  const auto cost = device_cost(log, layout, 0, 100);
  const std::vector<double> own{0, 0};
  std::vector<double> residuals(100);
  for (const auto& [index, value] :
       {std::pair{layout.mass, 0.0}, std::pair{layout.mass, -1.0}, std::pair{layout.damping, -1.0},
        std::pair{layout.coulomb, -0.1}, std::pair{layout.delay, -1e-9},
        std::pair{layout.offset, std::nan("")}}) {
    std::vector<double> values = truth(twin, layout);
    values[index] = value;
    EXPECT_FALSE(cost->Evaluate(std::vector<const double*>{values.data(), own.data()}.data(),
                                residuals.data(), nullptr))
        << index << " = " << value;
  }
}

}  // namespace
}  // namespace hvp::fit::device_cost_test
