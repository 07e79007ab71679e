// What several logs, or the quarters of one, say together.
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/app/cli/fit_command.h"

namespace hvp::cli::fit_logs_test {
namespace {

using nlohmann::json;
using test::FitCommand;
using ::testing::HasSubstr;
using ::testing::Not;

// Two specimens of one kind and a third that is a quarter stiffer: what lies between them is in the
// interval, which each log's own leaves out, and the noise of one is not blamed for it.
TEST_F(FitCommand, IntervalsOfSeveralLogsHoldWhatLiesBetweenThem) {
  std::vector<double> stiffness = {100, 102, 97};
  for (std::size_t i = 0; i < stiffness.size(); ++i) {
    bounce({fmt::format("device.dynamics.mass={} g", stiffness[i])});
    std::filesystem::copy_file(place_.path() / "bounce/frames.csv",
                               place_.path() / fmt::format("{}.csv", i),
                               std::filesystem::copy_options::overwrite_existing);
  }
  const auto fitted = [&](std::vector<std::string> logs, std::vector<std::string> more) {
    logs.insert(logs.end(), {"--model", "device", "--column", "time_us=born_us", "--column",
                             "force_N=fz_N", "--column", "position_m=z_m"});
    logs.insert(logs.end(), more.begin(), more.end());
    return fit(logs);
  };
  const json one = json::parse(fitted({"0.csv"}, {"--json"}).out);
  EXPECT_TRUE(one.at("logs").empty());
  EXPECT_FALSE(parameter(one, "mass").contains("between"));
  EXPECT_THAT(one.at("warnings").back().get<std::string>(), HasSubstr("of this log alone"));
  EXPECT_LT(parameter(one, "mass").at("high").get<double>(), 0.102);

  const Ended ended = fitted({"0.csv", "1.csv", "2.csv"}, {"--json", "--out", "all.toml"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const json all = json::parse(ended.out);
  const json mass = parameter(all, "mass");
  for (const double truth : {0.100, 0.102, 0.097}) {
    EXPECT_LT(mass.at("low"), truth);
    EXPECT_GT(mass.at("high"), truth);
  }
  // The sample's own standard deviation, since noise is a hundredth of it.
  EXPECT_NEAR(mass.at("between").at("deviation"), 2.5e-3, 2e-4);
  EXPECT_LT(mass.at("between").at("probability"), 1e-6);
  EXPECT_LT(mass.at("between").at("next_low"), mass.at("low"));
  EXPECT_THAT(all.at("warnings").front().get<std::string>(),
              HasSubstr("the logs disagree on mass"));
  ASSERT_EQ(all.at("logs").size(), 3U);
  EXPECT_NEAR(all.at("logs").at(2).at("values").at(0), 0.097, 2e-4);
  EXPECT_EQ(all.at("samples"), 3 * one.at("samples").get<int>());
  const std::string table = read(place_.path() / "all.toml");
  EXPECT_THAT(table, HasSubstr("mass = \"0.0996"));
  EXPECT_EQ(hvp(place_.path(), {"run", scenario("wall.toml").string(), "--include", "all.toml",
                                "--out", "with", "--set", "output.pictures=false"})
                .status,
            0);
  // In their order, and not of one that is twice there.
  EXPECT_THAT(fitted({"2.csv", "0.csv", "1.csv"}, {}).out, HasSubstr("2.csv, 0.csv, 1.csv"));
  expect_refused(fitted({"0.csv", "./0.csv"}, {}), "./0.csv: the log is given twice");
  expect_refused(fit({"0.csv", "1.csv", "--model", "host"}), "--model host: expected one log");
  expect_refused(fitted({"0.csv", "missing.csv"}, {}), "missing.csv");
}

// A device whose friction grows by half in the middle of the log: no interval of one model holds
// it, and the note says where it is from. One that stays as it is has no such note.
TEST_F(FitCommand, QuartersOfALogThatDisagreeWidenItsIntervals) {
  const auto log = [&](const std::string& name, double later) {
    double x = 0;
    double v = 0;
    std::string text = "time_s,force_N,position_m\n";
    constexpr int kSamples = 8000;
    for (int i = 0; i < kSamples; ++i) {
      const double t = 1e-3 * i;
      const double force = 0.8 * std::sin(9 * t) + 0.5 * std::sin(31 * t);
      text += fmt::format("{:.6f},{:.9f},{:.7f}\n", t, force, x);
      const double damping = i < kSamples / 2 ? 2.0 : later;
      for (int step = 0; step < 10; ++step) {
        v += 1e-4 * (force - damping * v) / 0.1;
        x += 1e-4 * v;
      }
    }
    write(name, text);
  };
  log("steady.csv", 2.0);
  log("changed.csv", 3.0);
  const std::vector<std::string> more = {"--model", "device", "--json", "--fix", "coulomb=0"};
  const auto fitted = [&](std::string name) {
    std::vector<std::string> arguments = {std::move(name)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return json::parse(fit(arguments).out);
  };
  const json changed = fitted("changed.csv");
  EXPECT_THAT(changed.at("warnings").front().get<std::string>(),
              HasSubstr("the quarters of this log disagree on"));
  EXPECT_LT(parameter(changed, "damping").at("low"), 2.0);
  EXPECT_GT(parameter(changed, "damping").at("high"), 3.0);
  EXPECT_LT(parameter(changed, "damping").at("between").at("probability"), 0.01);
  const json steady = fitted("steady.csv");
  EXPECT_THAT(steady.at("warnings").dump(), Not(HasSubstr("disagree on damping")));
  EXPECT_NEAR(parameter(steady, "damping").at("value"), 2.0, 0.02);
  EXPECT_LT(parameter(steady, "damping").at("high"), 2.1);
}

// Two specimens that are alike: no disagreement, an interval that holds the truth and is wide, and
// a value that is known stays as it is.
TEST_F(FitCommand, TwoLogsThatAgreeTellLittleOfOthers) {
  press("a.csv", 1e-3, 1);
  press("b.csv", 1e-3, 2);
  const json same =
      json::parse(fit({"a.csv", "b.csv", "--model", "qlv", "--json", "--plot", "p.png"}).out);
  EXPECT_GT(parameter(same, "q").at("between").at("probability").get<double>(), 0.01);
  EXPECT_LT(parameter(same, "q").at("low"), 600);
  EXPECT_GT(parameter(same, "q").at("high"), 600);
  EXPECT_GT(parameter(same, "q").at("low").get<double>(), 0);
  EXPECT_THAT(same.at("warnings").dump(), HasSubstr("two logs tell little"));
  const json given = json::parse(
      fit({"a.csv", "b.csv", "--model", "qlv", "--json", "--fix", "contact=0.0004"}).out);
  EXPECT_TRUE(parameter(given, "contact").at("fixed"));
  EXPECT_FALSE(parameter(given, "contact").contains("between"));
}

}  // namespace
}  // namespace hvp::cli::fit_logs_test
