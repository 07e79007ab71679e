#include "models/fit/device_log.h"

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fit/device_problem.h"
#include "models/fit/twins.h"

namespace hvp::fit::device_log_test {
namespace {

TEST(FitDeviceWindows, BeginWhereTheAxisIsFast) {
  std::vector<double> velocities(1000);
  for (std::size_t i = 0; i < 1000; ++i) {
    const auto t = static_cast<double>(i);
    velocities[i] = i > 400 && i < 650 ? 0 : std::sin(0.05 * t);
  }
  const std::vector<std::size_t> begins = device_windows(velocities, 100);
  ASSERT_GE(begins.size(), 6U);
  EXPECT_EQ(begins.back(), 1000U);
  bool over_the_rest = false;
  for (std::size_t i = 0; i + 1 < begins.size(); ++i) {
    EXPECT_GT(std::abs(velocities[begins[i]]), 0.3 * 0.6);
    EXPECT_GE(begins[i + 1], begins[i] + 50);
    over_the_rest = over_the_rest || (begins[i] <= 400 && begins[i + 1] >= 650);
  }
  EXPECT_TRUE(over_the_rest);
  EXPECT_EQ(device_windows(std::vector<double>(60, 1.0), 250).size(), 2U);
}

// Starts and ranges lie within the bounds, whatever the rate of samples.
TEST(FitDevice, StartsAreAdmissibleAtAnyRate) {
  for (const double period : {1e-5, 1e-3, 0.1, 5.0}) {
    DeviceTwin twin;
    twin.period = 1e-3;
    DeviceLog log = twin.follow(busy_command(600, twin.period, 1));
    log.period = period;
    DeviceOptions options;
    options.lag = true;
    options.command = DeviceCommand::current;
    options.fixed = {{"mass", 0.05}};
    const DeviceProblem problem(log, options);
    for (const Parameter& p : problem.parameters()) {
      EXPECT_LE(p.low, p.start) << p.name << " at " << period;
      EXPECT_LE(p.start, p.high) << p.name << " at " << period;
      EXPECT_LE(p.low, p.draw_low) << p.name << " at " << period;
      EXPECT_LE(p.draw_low, p.draw_high) << p.name << " at " << period;
      EXPECT_LE(p.draw_high, p.high) << p.name << " at " << period;
      EXPECT_GT(p.matters, 0) << p.name << " at " << period;
    }
  }
}

std::string refusal(const DeviceLog& log, const DeviceOptions& options = {}) {
  try {
    const DeviceProblem problem(log, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(FitDevice, RefusesWhatNoFitMakesSenseOf) {
  const DeviceTwin twin;
  const DeviceLog log = twin.follow(busy_command(2000, twin.period, 1));
  EXPECT_EQ(refusal(log), "");

  DeviceLog bad = twin.follow(busy_command(40, twin.period, 1));
  EXPECT_NE(refusal(bad).find("40 samples"), std::string::npos);
  bad = log;
  bad.position.assign(bad.position.size(), 0.1);
  EXPECT_NE(refusal(bad).find("position (m) never changes"), std::string::npos);
  bad = log;
  bad.command.assign(bad.command.size(), 0.1);
  EXPECT_NE(refusal(bad).find("force (N) never changes"), std::string::npos);
  bad = log;
  bad.position[77] = std::nan("");
  EXPECT_NE(refusal(bad).find("sample 78"), std::string::npos);
  bad = log;
  bad.position.pop_back();
  EXPECT_NE(refusal(bad).find("1999"), std::string::npos);
  bad = log;
  bad.period = 0;
  EXPECT_NE(refusal(bad).find("must be positive"), std::string::npos);
  bad = log;
  std::swap(bad.command, bad.position);
  EXPECT_NE(refusal(bad).find("swapped"), std::string::npos);
  bad = log;
  for (double& x : bad.position) x = -x;
  EXPECT_NE(refusal(bad).find("sign"), std::string::npos);
  bad = log;
  for (double& x : bad.position) x *= 1e-6;  // millimetres for kilometres
  EXPECT_NE(refusal(bad).find("beyond 1e-07 to 1e+03"), std::string::npos);
}

// A swept sinusoid looks as smooth as its answer; an axis does not answer with negative damping.
TEST(FitDevice, RefusesSmoothColumnsSwapped) {
  DeviceTwin twin;
  std::vector<double> command;
  for (int i = 0; i < 4000; ++i) {
    const double t = i * twin.period;
    command.push_back(std::sin(DeviceTwin::kTwoPi * (1 + t) * t));
  }
  DeviceLog log = twin.follow(command);
  EXPECT_EQ(refusal(log), "");
  std::swap(log.command, log.position);
  EXPECT_NE(refusal(log).find("swapped"), std::string::npos);
}

}  // namespace
}  // namespace hvp::fit::device_log_test
