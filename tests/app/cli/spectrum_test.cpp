#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "tests/app/cli/linear_systems.h"

// The effect [spectrum]: bounds of eigenvalues, where a run asks for them.
namespace hvp::cli::spectrum_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

void expect_inside(const json& bounds, double value) {
  EXPECT_LE(bounds.at(0), value * (1 + 1e-12));
  EXPECT_GE(bounds.at(1), value * (1 - 1e-12));
  EXPECT_LE(bounds.at(1).get<double>() - bounds.at(0).get<double>(), 0.011 * value);
}

// Eigenvalues of the chain: 2 − 2·cos(kπ/(n + 1)).
TEST(Spectrum, OfAChain) {
  constexpr int kLinks = 22;
  const SystemFolder folder(kLinks, chain(kLinks), std::vector<double>(kLinks, 1.0));
  const double angle = std::numbers::pi / (kLinks + 1);
  const double smallest = 2 - 2 * std::cos(angle);
  const double largest = 2 - 2 * std::cos(kLinks * angle);
  const json condition = folder.result({"spectrum=true"}).at("condition");
  expect_inside(condition.at("given").at("smallest"), smallest);
  expect_inside(condition.at("given").at("largest"), largest);
  const json& kappa = condition.at("given").at("condition");
  EXPECT_LE(kappa.at(0), largest / smallest);
  EXPECT_GE(kappa.at(1), largest / smallest);
  EXPECT_EQ(condition.at("scaled"), nullptr);
  // With its diagonal of one the chain is half as stiff.
  const json scaled =
      folder.result({"spectrum=true", "solver.matrix_scaling=diagonal"}).at("condition");
  expect_inside(scaled.at("scaled").at("largest"), largest / 2);
}

class SpectrumOfARun : public ::testing::Test {
 protected:
  SpectrumOfARun() { write(place_.path() / "s.toml", kSmallScene); }

  Ended run(std::vector<std::string> more) {
    more.insert(more.begin(), {"run", "s.toml", "--out", "out", "--set", "frames=4"});
    return hvp(place_.path(), more);
  }
  json summary() const { return json::parse(read(place_.path() / "out/summary.json")); }

  ScratchDirectory place_;
};

TEST_F(SpectrumOfARun, IsNullUnlessAskedFor) {
  const Ended ended = run({});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(summary().at("condition"), nullptr);
  EXPECT_THAT(ended.out, Not(HasSubstr("Spectrum")));
}

TEST_F(SpectrumOfARun, IsBoundedWhereAskedFor) {
  const Ended ended = run({"--set", "spectrum=true"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  const json condition = summary().at("condition");
  for (const char* which : {"given", "rounded"}) {
    const json& kappa = condition.at(which).at("condition");
    EXPECT_GT(kappa.at(0), 1) << which;
    EXPECT_LE(kappa.at(1).get<double>() / kappa.at(0).get<double>(), 1.025) << which;
  }
  EXPECT_THAT(ended.out, HasSubstr("Spectrum     of the system without contact"));
  EXPECT_EQ(summary().at("effects"), json({"reference", "spectrum"}));
  const Ended explained = hvp(place_.path(), {"explain", "s.toml", "--set", "spectrum=true"});
  EXPECT_THAT(explained.out, HasSubstr("Spectrum of the system without contact"));
  EXPECT_THAT(explained.out, HasSubstr("true matrix"));
}

// Rounding to 8 bits leaves negative eigenvalues, which a warm solve of few iterations may not
// meet. Without the reference nothing else would tell.
TEST_F(SpectrumOfARun, FlagsAMatrixThatRoundingMadeIndefinite) {
  const std::vector<std::string> indefinite = {"--set", "object.material.poisson_ratio=0.4999",
                                               "--set", "solver.matrix_bits=8",
                                               "--set", "solver.iterations=1",
                                               "--set", "reference=false"};
  std::vector<std::string> asked = indefinite;
  asked.insert(asked.end(), {"--set", "spectrum=true"});
  const Ended ended = run(asked);
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(summary().at("stability").at("flags").dump(), HasSubstr("negative-curvature"));
  EXPECT_EQ(summary().at("condition").at("rounded").at("condition"), nullptr);
  EXPECT_LT(summary().at("condition").at("rounded").at("smallest").at(1), 0);
  EXPECT_THAT(ended.out, HasSubstr("not positive definite"));
  EXPECT_THAT(ended.out, Not(HasSubstr("PASS")));
}

}  // namespace
}  // namespace hvp::cli::spectrum_test
