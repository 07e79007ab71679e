#pragma once

#include <cstdint>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "models/fit/twins.h"
#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// `hvp fit` as a user meets it, on logs that the platform and the models themselves make.
namespace hvp::cli::test {

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
    EXPECT_THAT(ended.err, ::testing::HasSubstr(words));
  }
  static nlohmann::json parameter(const nlohmann::json& fitted, const std::string& name) {
    for (const nlohmann::json& p : fitted.at("parameters")) {
      if (p.at("name") == name) return p;
    }
    ADD_FAILURE() << "no parameter " << name;
    return {};
  }

  const ScratchDirectory place_;
};

}  // namespace hvp::cli::test
