#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "models/fit/qlv_twin.h"
#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// `hvp fit` as a user meets it, on logs that the platform and the models themselves make.
namespace hvp::cli {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class FitCommand : public ::testing::Test {
 protected:
  // A device of 0.1 kg with 1 N s/m falls onto a wall, 0.3 ms late, and bounces.
  void bounce(const std::vector<std::string>& settings = {}) const {
    std::vector<std::string> arguments = {"run", scenario("wall.toml").string(), "--out", "bounce"};
    for (const std::string& setting :
         {std::string("wall.sides=one"), std::string("device.gravity=true"),
          std::string("wall.stiffness=300 N/m"), std::string("host.delay.time=0.3 ms"),
          std::string("probe.start=[\"0 mm\", \"0 mm\", \"30 mm\"]"),
          std::string("probe.motion[0].to=[\"0 mm\", \"0 mm\", \"30 mm\"]"),
          std::string("output.pictures=false")}) {
      arguments.insert(arguments.end(), {"--set", setting});
    }
    for (const std::string& setting : settings) {
      arguments.insert(arguments.end(), {"--set", setting});
    }
    const Ended ended = hvp(place_.path(), arguments);
    ASSERT_EQ(ended.status, 0) << ended.err;
  }
  Ended fit(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "fit");
    return hvp(place_.path(), arguments);
  }
  Ended fit_device(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {"bounce/frames.csv", "--model",         "device",
                                          "--column",          "time_us=born_us", "--column",
                                          "force_N=fz_N",      "--column",        "position_m=z_m"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return fit(arguments);
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(place_.path() / name) << text;
  }
  void press(const std::string& name, double noise, std::int64_t seed) const {
    const fit::IndentationLog log =
        fit::press({}, {}, {170, 600, 0.62, 0.3, 0.18, 4, 0.4e-3, 0.01}, noise, seed);
    std::string text = "time_s,force_mN,travel_mm\n";
    for (std::size_t i = 0; i < log.time.size(); ++i) {
      text += std::to_string(log.time[i]) + "," + std::to_string(1e3 * log.force[i]) + "," +
              std::to_string(1e3 * log.travel[i]) + "\n";
    }
    write(name, text);
  }
  void expect_refused(const Ended& ended, const std::string& words) const {
    EXPECT_EQ(ended.status, 2) << ended.out;
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(words));
  }
  static json parameter(const json& fitted, const std::string& name) {
    for (const json& p : fitted.at("parameters")) {
      if (p.at("name") == name) return p;
    }
    ADD_FAILURE() << "no parameter " << name;
    return {};
  }

  const ScratchDirectory place_;
};

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
  EXPECT_LT(fitted.at("held_out_rms"), 2e-9);
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

TEST_F(FitCommand, FindsTissueAndDrawsIt) {
  press("tissue.csv", 2e-3, 3);
  const Ended ended = fit({"tissue.csv", "--model", "qlv", "--json", "--starts", "3"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const json fitted = json::parse(ended.out);
  EXPECT_NEAR(fitted.at("residual_rms"), 2e-3, 5e-4);
  const std::vector<std::pair<std::string, double>> truth = {
      {"q", 600}, {"g1", 0.62}, {"tau1", 0.3}, {"tau2", 4}};
  for (const auto& [name, value] : truth) {
    const json p = parameter(fitted, name);
    EXPECT_TRUE(p.at("identifiable")) << name;
    EXPECT_LE(p.at("low").get<double>(), value + 0.1 * value) << name;
    EXPECT_GE(p.at("high").get<double>(), value - 0.1 * value) << name;
  }
  const Ended text = fit({"tissue.csv", "--model", "qlv", "--starts", "1", "--fix", "offset=0.01"});
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("fixed"));
  EXPECT_THAT(text.out, HasSubstr("left over"));
}

TEST_F(FitCommand, AnswersAreTheSameBytesAgain) {
  press("tissue.csv", 2e-3, 3);
  const std::vector<std::string> arguments = {"tissue.csv", "--model", "qlv", "--json"};
  EXPECT_EQ(fit(arguments).out, fit(arguments).out);
}

TEST_F(FitCommand, WrongInputEndsInOneLine) {
  press("tissue.csv", 2e-3, 3);
  expect_refused(fit({"nothing.csv", "--model", "qlv"}), "nothing.csv");
  expect_refused(fit({"tissue.csv", "--model", "glue"}), "device");
  expect_refused(fit({"tissue.csv", "--model", "qlv", "--fix", "stiffness=3"}), "tau1");
  expect_refused(fit({"tissue.csv", "--model", "qlv", "--fix", "c"}), "NAME=NUMBER");
  expect_refused(fit({"tissue.csv", "--model", "qlv", "--fix", "g1=2"}), "g1");
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
}  // namespace hvp::cli
