// The keys of [object.model.matrix], as a user gives them.
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

namespace hvp::cli::matrix_renewal_test {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

class MatrixRenewal : public ::testing::Test {
 protected:
  Ended with(const std::vector<std::string>& changes, const char* name = "thesis-nonlinear.toml") {
    std::vector<std::string> arguments = run_for_figures(name, changes);
    if (with_fault_) arguments.insert(arguments.begin() + 2, {"--include", "fault.toml"});
    return hvp(place_.path(), arguments);
  }
  json summary() const { return json::parse(read(place_.path() / "out/summary.json")); }

  ScratchDirectory place_;
  bool with_fault_ = false;
};

TEST_F(MatrixRenewal, NeverIsAcceptedWhoeverSolves) {
  const std::string never = "object.model.matrix.renew_every=0";
  for (const char* solver : {"board", "cg", "cholesky"}) {
    const Ended ended = with({never, "frames=5", std::string("host.solver=") + solver});
    EXPECT_LT(ended.status, 2) << solver << ": " << ended.err;
    EXPECT_FALSE(summary().contains("matrix"));
  }
  const Ended steps = with({never, "frames=5"}, "tissue-explicit.toml");
  EXPECT_LT(steps.status, 2) << steps.err;
}

TEST_F(MatrixRenewal, NeedsAMatrix) {
  const Ended ended =
      with({"object.model.matrix.renew_every=1", "frames=5"}, "tissue-explicit.toml");
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, HasSubstr("explicit steps have no matrix"));
}

// A core makes new factors; that is as much as the frame has on top in `hvp explain`.
TEST_F(MatrixRenewal, IsTheHostsToo) {
  const std::vector<std::string> changes = {"object.model.matrix.renew_every=20",
                                            "frames=140",
                                            "budget.period=40ms",
                                            "host.model=desktop-2026",
                                            "host.solver=cholesky",
                                            "contact.kind=node",
                                            "transfer.method=bursts"};
  const Ended ended = with(changes);
  EXPECT_LT(ended.status, 2) << ended.err;
  const json s = summary();
  EXPECT_GT(s.at("matrix").at("renewed"), 0);
  EXPECT_EQ(s.at("matrix").at("not_defined"), 0);
  EXPECT_EQ(s.at("matrix").at("beyond_scale"), 0);
  EXPECT_GT(s.at("matrix").at("growth"), 0.9);
  std::vector<std::string> explain = {"explain", scenario("thesis-nonlinear.toml").string(),
                                      "--json"};
  for (const std::string& change : changes) {
    explain.emplace_back("--set");
    explain.push_back(change);
  }
  const json steps =
      json::parse(hvp(place_.path(), explain).out).at("frame").at("renewal").at("steps");
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_EQ(steps.at(1).at("what"), "assemble: the solver's set-up");
  EXPECT_GT(steps.at(1).at("us").get<double>(), 1000);
}

// Nothing touches the body so soon.
TEST_F(MatrixRenewal, HasNoGrowthWhereNoMatrixWasFormed) {
  const Ended ended = with({"object.model.matrix.renew_every=2", "frames=5"});
  EXPECT_LT(ended.status, 2) << ended.err;
  EXPECT_EQ(summary().at("matrix").at("renewed"), 0);
  EXPECT_TRUE(summary().at("matrix").at("growth").is_null());
}

// By blocks and by DMA.
TEST_F(MatrixRenewal, AFaultInTheValuesHasItsName) {
  with_fault_ = true;
  write(place_.path() / "fault.toml",
        "[[fault]]\nkind = \"master-abort\"\nframe = 98\naccess = \"values\"\n");
  for (const auto& [method, error] :
       {std::pair("bursts", "HVP_ERROR_BUS"), std::pair("dma", "HVP_ERROR_DMA")}) {
    const Ended ended = with({"object.model.matrix.renew_every=20", "frames=130",
                              "budget.period=4ms", std::string("transfer.method=") + method});
    EXPECT_EQ(ended.status, 1) << ended.err;
    const json s = summary();
    EXPECT_THAT(s.at("stability").at("flags"), Contains("bus-error")) << method;
    EXPECT_THAT(s.at("stability").at("flags"), Not(Contains("solver-timeout"))) << method;
    EXPECT_EQ(s.at("driver").at("errors").at(error).at("first_frame"), 98);
    EXPECT_EQ(s.at("driver").at("recoveries"), 1);
    EXPECT_GT(s.at("matrix").at("growth"), 0);
  }
}

}  // namespace
}  // namespace hvp::cli::matrix_renewal_test
