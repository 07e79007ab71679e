// What every fit of a command has, and those of a device and a hand.
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "models/fit/twins.h"
#include "tests/app/cli/fit_command.h"

namespace hvp::cli::fit_test {
namespace {

using nlohmann::json;
using test::FitCommand;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(FitCommand, FindsTheDeviceThatMadeTheLog) {
  bounce();
  const Ended ended = fit_device({"--json"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.err, "");
  const json fitted = json::parse(ended.out);
  EXPECT_EQ(fitted.at("model"), "device");
  EXPECT_NEAR(parameter(fitted, "mass").at("value"), 0.1, 1e-6);
  EXPECT_NEAR(parameter(fitted, "damping").at("value"), 1, 1e-5);
  EXPECT_NEAR(parameter(fitted, "coulomb").at("value"), 0, 1e-6);
  EXPECT_NEAR(parameter(fitted, "offset").at("value"), -0.980665, 1e-5);
  EXPECT_NEAR(parameter(fitted, "delay").at("value"), 0.3e-3, 1e-7);
  EXPECT_EQ(fitted.at("starts").at("reached"), fitted.at("starts").at("tried"));
  // Positions are read to a nanometre.
  EXPECT_LT(fitted.at("residual_rms"), 2e-9);
  EXPECT_LT(fitted.at("held_out_rms"), 2e-8);
  EXPECT_EQ(fitted.at("correlations").size(), 5U);
}

// The largest stable stiffness of what was fitted is that of the truth, as far as the intervals of
// the fit leave it open.
TEST_F(FitCommand, FittedDeviceHoldsTheWallThatTheTrueOneHolds) {
  bounce({"device.encoder.resolution=20 um", "device.friction.force=50 mN"});
  const Ended ended = fit_device({"--json", "--out", "fitted.toml"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const json fitted = json::parse(ended.out);
  const json damping = parameter(fitted, "damping");
  EXPECT_LE(damping.at("low"), 1.0);
  EXPECT_GE(damping.at("high"), 1.0);
  const json friction = parameter(fitted, "coulomb");
  EXPECT_LE(friction.at("low"), 0.05);
  EXPECT_GE(friction.at("high"), 0.05);

  write("wall.toml", "base = \"" + scenario("wall.toml").string() +
                         "\"\ninclude = \"fitted.toml\"\n[device]\nfriction = false\n");
  const auto stiffest = [&](const std::vector<std::string>& settings) {
    std::vector<std::string> arguments = {"stability", "wall.toml", "--json"};
    for (const std::string& setting : settings) {
      arguments.insert(arguments.end(), {"--set", setting});
    }
    const Ended found = hvp(place_.path(), arguments);
    EXPECT_EQ(found.status, 0) << found.err;
    return json::parse(found.out).at("stiffness_max").get<double>();
  };
  const auto with = [&](double b) {
    return stiffest({"device.dynamics.damping=" + std::to_string(b) + " N s/m"});
  };
  const double found = stiffest({});
  const double true_one =
      stiffest({"device.dynamics.damping=1 N s/m", "device.dynamics.mass=100 g"});
  EXPECT_NEAR(true_one, 1003, 5);
  EXPECT_NE(found, true_one);
  EXPECT_GE(true_one, 0.995 * with(damping.at("low")));
  EXPECT_LE(true_one, 1.005 * with(damping.at("high")));
  EXPECT_NEAR(found, true_one, 0.1 * true_one);
}

TEST_F(FitCommand, FindsAHand) {
  // m x" = F - b x' - k x for a hand of 1.5 kg on 375 N/m with 4.5 N s/m, in its two closed forms.
  std::string text = "time_ms,force_N,position_mm,intended_mm\n";
  const double pi = std::acos(-1.0);
  for (int i = 0; i < 4000; ++i) {
    const double t = 1e-3 * i;
    double force = 0;
    double x = 0;
    for (const double f : {1.1, 2.3, 3.9, 6.7}) {
      const double w = 2 * pi * f;
      const double stiff = 375 - 1.5 * w * w;
      const double viscous = 4.5 * w;
      force += std::sin(w * t);
      x += (stiff * std::sin(w * t) - viscous * std::cos(w * t)) /
           (stiff * stiff + viscous * viscous);
    }
    text +=
        std::to_string(i) + "," + std::to_string(force) + "," + std::to_string(1e3 * x) + ",0\n";
  }
  write("hand.csv", text);
  const Ended ended =
      fit({"hand.csv", "--model", "hand", "--json", "--starts", "2", "--out", "hand.toml"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const json fitted = json::parse(ended.out);
  EXPECT_NEAR(parameter(fitted, "mass").at("value"), 1.5, 1e-3);
  EXPECT_NEAR(parameter(fitted, "stiffness").at("value"), 375, 0.1);
  EXPECT_NEAR(parameter(fitted, "damping").at("value"), 4.5, 1e-2);
  const Ended explained = hvp(
      place_.path(), {"explain", scenario("wall-in-hand.toml").string(), "--include", "hand.toml"});
  EXPECT_EQ(explained.status, 0) << explained.err;
}

TEST_F(FitCommand, AnswersAreTheSameBytesAgain) {
  press("tissue.csv", 2e-3, 3);
  const std::vector<std::string> arguments = {"tissue.csv", "--model", "qlv", "--json"};
  EXPECT_EQ(fit(arguments).out, fit(arguments).out);
}

TEST_F(FitCommand, APictureLeavesTheLogAsItIs) {
  press("tissue.csv", 2e-3, 3);
  const std::string before = read(place_.path() / "tissue.csv");
  const Ended ended =
      fit({"tissue.csv", "--model", "qlv", "--starts", "1", "--plot", "tissue.png"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(read(place_.path() / "tissue.csv"), before);
  EXPECT_TRUE(std::filesystem::exists(place_.path() / "tissue.fit.csv"));
}

// A motion that never reverses has friction and offset in one number.
TEST_F(FitCommand, OneWayMotionGivesNeitherFrictionNorOffset) {
  const fit::DeviceTwin twin;
  std::vector<double> command = fit::busy_command(3000, twin.period, 0.4);
  for (double& c : command) c = 0.6 + c;
  const fit::DeviceLog log = twin.follow(command);
  std::string text = "time_ms,force_N,position_mm\n";
  for (std::size_t i = 0; i < command.size(); ++i) {
    text += fmt::format("{},{},{}\n", i, command[i], 1e3 * log.position[i]);
  }
  write("one-way.csv", text);
  const Ended ended =
      fit({"one-way.csv", "--model", "device", "--json", "--starts", "2", "--out", "fitted.toml"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const json fitted = json::parse(ended.out);
  EXPECT_FALSE(parameter(fitted, "coulomb").at("identifiable"));
  EXPECT_FALSE(parameter(fitted, "offset").at("identifiable"));
  EXPECT_TRUE(parameter(fitted, "mass").at("identifiable"));
  EXPECT_THAT(parameter(fitted, "coulomb").at("remedy").get<std::string>(), HasSubstr("reverses"));
  EXPECT_THAT(read(place_.path() / "fitted.toml"), Not(HasSubstr("\nforce =")));
}

TEST_F(FitCommand, AnInterruptionLeavesTheBestSoFar) {
  press("tissue.csv", 2e-3, 3);
  // A machine under load may not have begun by then: a signal then ends it without a word.
  Ended ended;
  for (const int delay_ms : {500, 1000, 2000, 4000}) {
    Program program(place_.path(), {"fit", "tissue.csv", "--model", "qlv", "--starts", "1000",
                                    "--seed", std::to_string(delay_ms), "--out", "fitted.toml"});
    std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
    program.signal(SIGINT);
    ended = program.wait();
    if (!ended.out.empty()) break;
  }
  EXPECT_EQ(ended.signal, SIGINT);
  EXPECT_THAT(ended.out, HasSubstr("stopped before the end"));
  EXPECT_THAT(read(place_.path() / "fitted.toml"), HasSubstr("stopped before the end"));
}

TEST_F(FitCommand, WrongInputEndsInOneLine) {
  press("tissue.csv", 2e-3, 3);
  expect_refused(fit({"nothing.csv", "--model", "qlv"}), "nothing.csv");
  expect_refused(fit({"tissue.csv", "--model", "glue"}), "device");
  expect_refused(fit({"tissue.csv", "--model", "qlv", "--fix", "stiffness=3"}), "tau1");
  expect_refused(fit({"tissue.csv", "--model", "qlv", "--fix", "c"}), "NAME=NUMBER");
  expect_refused(fit({"tissue.csv", "--model", "qlv", "--fix", "g1=2"}), "g1");
  expect_refused(fit({"tissue.csv", "--model", "qlv", "--fix", "c=1", "--fix", "c=2"}), "twice");
  expect_refused(fit({"tissue.csv", "--model", "qlv", "--set", "elastic=glue"}), "fung");
  expect_refused(fit({"tissue.csv", "--model", "qlv", "--out", "fitted.txt"}), ".toml");
  expect_refused(fit({"tissue.csv", "--model", "qlv", "--plot", "none/fit.png"}), "no folder");
  expect_refused(fit({"tissue.csv", "--model", "device"}), "");
  expect_refused(fit({"tissue.csv", "--model", "tissue"}), "--scenario");
  write("short.csv", "time_s,force_N,travel_mm\n0,0,0\n1,1,1\n");
  expect_refused(fit({"short.csv", "--model", "qlv"}), "short.csv");
  EXPECT_FALSE(std::filesystem::exists(place_.path() / "fitted.txt"));
}

}  // namespace
}  // namespace hvp::cli::fit_test
