// Fits of tissue and of a body.
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "tests/app/cli/fit_command.h"

namespace hvp::cli::fit_tissue_test {
namespace {

using nlohmann::json;
using test::FitCommand;
using ::testing::HasSubstr;

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

// What the fit writes of a specimen is a body that a run takes as it stands.
TEST_F(FitCommand, MakesATissueThatRuns) {
  press("tissue.csv", 2e-3, 3);
  const Ended ended =
      fit({"tissue.csv", "--model", "qlv", "--starts", "3", "--set", "specimen.area=7.85e-5",
           "--set", "specimen.height=10mm", "--out", "meat.toml"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("the material's forces as a column are"));
  const std::string table = read(place_.path() / "meat.toml");
  for (const char* words : {"[object.material]", "young_modulus", "[object.model]",
                            "kind = \"fung\"", "exponent", "prony = [{ share = "}) {
    EXPECT_THAT(table, HasSubstr(words));
  }
  const Ended run =
      hvp(place_.path(), {"run", scenario("thesis-nonlinear.toml").string(), "--include",
                          "meat.toml", "--set", "frames=260", "--set", "output.pictures=false",
                          "--set", "output.remedies=false", "--out", "out"});
  EXPECT_LT(run.status, 2) << run.err;
  EXPECT_THAT(run.out, HasSubstr("dynamic, fung"));
  expect_refused(fit({"tissue.csv", "--model", "qlv", "--set", "specimen.area=7.85e-5"}), "height");
}

// The platform's own body, pressed by its own probe and solved exactly: what it is made of comes
// back, up to the node's few hundredths of a millimetre sideways that the model leaves out and
// says.
TEST_F(FitCommand, FindsWhatARunsBodyIsMadeOf) {
  write("press.toml", "base = \"" + scenario("thesis-static.toml").string() + R"("
frames = 250
reference = false
[object.mesh]
nodes = 159
[object.material]
young_modulus = "7 kPa"
[host]
solver = "cholesky"
[probe]
start = ["0 mm", "0 mm", "55 mm"]
[[probe.motion]]
phase = "press"
to = ["0 mm", "0 mm", "42 mm"]
duration = "0.3 s"
[[probe.motion]]
phase = "press"
to = ["0 mm", "0 mm", "45 mm"]
duration = "0.1 s"
)");
  ASSERT_EQ(
      hvp(place_.path(), {"run", "press.toml", "--out", "press", "--set", "output.pictures=false"})
          .status,
      0);
  const Ended ended = fit({"press/frames.csv", "--model", "tissue", "--scenario", "press.toml",
                           "--set", "frames=true", "--fix", "poisson_ratio=0.45", "--starts", "2",
                           "--json", "--out", "fitted.toml"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const json fitted = json::parse(ended.out);
  EXPECT_NEAR(parameter(fitted, "young_modulus").at("value"), 7000, 0.004 * 7000);
  EXPECT_THAT(fitted.at("warnings").dump(), HasSubstr("aside of its way"));
  write("again.toml", "base = \"press.toml\"\ninclude = \"fitted.toml\"\n");
  const Ended explained = hvp(place_.path(), {"explain", "again.toml"});
  EXPECT_EQ(explained.status, 0) << explained.err;
}

// The same of a body that a proxy pressed, at rest or with inertia, and slid over: how the force
// comes about is known to the last digit.
TEST_F(FitCommand, FindsWhatABodyUnderAProxyIsMadeOf) {
  const auto written = [&](const std::string& base) {
    return "base = \"" + scenario(base).string() + R"("
frames = 300
reference = false
[contact]
kind = "proxy"
[object.mesh]
nodes = 159
[object.material]
young_modulus = "7 kPa"
[host]
solver = "cholesky"
[probe]
start = ["2 mm", "1 mm", "52 mm"]
[[probe.motion]]
phase = "press"
to = ["2 mm", "1 mm", "45 mm"]
duration = "0.2 s"
[[probe.motion]]
phase = "slide"
to = ["9 mm", "1 mm", "45 mm"]
duration = "0.3 s"
)";
  };
  write("static.toml", written("thesis-static.toml"));
  write("dynamic.toml", written("thesis.toml"));
  for (const std::string name : {"static", "dynamic"}) {
    ASSERT_LT(hvp(place_.path(), {"run", name + ".toml", "--out", name, "--set",
                                  "output.pictures=false", "--set", "output.remedies=false"})
                  .status,
              2);
    std::vector<std::string> arguments = {name + "/frames.csv",
                                          "--model",
                                          "tissue",
                                          "--scenario",
                                          name + ".toml",
                                          "--set",
                                          "frames=true",
                                          "--starts",
                                          "2",
                                          "--json",
                                          "--fix",
                                          "poisson_ratio=0.45"};
    const Ended ended = fit(arguments);
    ASSERT_EQ(ended.status, 0) << ended.err;
    const json fitted = json::parse(ended.out);
    EXPECT_NEAR(parameter(fitted, "young_modulus").at("value"), 7000, 1e-3 * 7000) << name;
    EXPECT_LT(fitted.at("residual_rms"), 1e-6);
    const auto refused = [&](const std::string& table, const std::string& words) {
      write("other.toml", "base = \"" + name + ".toml\"\n" + table);
      arguments[4] = "other.toml";
      expect_refused(fit(arguments), words);
    };
    refused("[contact]\nkind = \"node\"\n",
            "the contact is a proxy, and that of --scenario is a node");
    refused("[contact]\nkind = \"patch\"\n", "expected another contact.kind than \"patch\"");
    refused("[loads.gravity]\n", "found loads on the body");
  }
}

}  // namespace
}  // namespace hvp::cli::fit_tissue_test
