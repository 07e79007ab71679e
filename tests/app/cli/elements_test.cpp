#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// Quadratic elements, as a user asks for them.
namespace hvp::cli::elements_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class ElementsOfABody : public ::testing::Test {
 protected:
  void SetUp() override { write(place_.path() / "s.toml", kSmallScene); }
  Ended command(const char* name, const std::vector<std::string>& changes) {
    std::vector<std::string> arguments = {name, "s.toml"};
    if (name != std::string("explain")) arguments.insert(arguments.end(), {"--out", "out"});
    for (const std::string& change : changes) {
      arguments.emplace_back("--set");
      arguments.push_back(change);
    }
    return hvp(place_.path(), arguments);
  }
  json run(const std::vector<std::string>& changes) {
    const Ended ended = command("run", changes);
    EXPECT_LT(ended.status, 2) << ended.err;
    out_ = ended.out;
    return json::parse(read(place_.path() / "out/summary.json"));
  }
  void expect_refused(const std::vector<std::string>& changes, const std::string& what) {
    const Ended ended = command("run", changes);
    EXPECT_EQ(ended.status, 2) << ended.out;
    EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(what));
    EXPECT_FALSE(std::filesystem::exists(place_.path() / "out/summary.json"));
  }

  ScratchDirectory place_;
  std::string out_;
};

const std::vector<std::string> kMean = {"object.elements=quadratic-mean-dilatation"};

TEST_F(ElementsOfABody, RunInTheLoop) {
  const json summary = run({kMean[0], "object.mesh.nodes=300", "output.pictures=true"});
  EXPECT_NEAR(summary.at("mesh").at("nodes"), 300, 30);
  EXPECT_GT(summary.at("force").at("largest").at("N"), 0);
  EXPECT_THAT(out_, HasSubstr(" quadratic mean-dilatation tetrahedra; "));
  EXPECT_TRUE(std::filesystem::exists(place_.path() / "out/deformation.png"));
  EXPECT_THAT(read(place_.path() / "out/scenario.resolved.toml"),
              HasSubstr("elements = \"quadratic-mean-dilatation\""));
}

TEST_F(ElementsOfABody, AreTheSameWithInertiaAndBothMasses) {
  for (const char* mass : {"lumped", "consistent"}) {
    const json summary = run(
        {kMean[0], "object.mesh.nodes=117", "dynamics=true", std::string("dynamics.mass=") + mass});
    EXPECT_GT(summary.at("force").at("largest").at("N"), 0) << mass;
  }
}

TEST_F(ElementsOfABody, HaveLongerRowsOnTheBoard) {
  const auto blocks = [&](const char* elements) {
    const Ended ended =
        hvp(place_.path(), {"explain", "s.toml", "--json", "--set", "object.mesh.nodes=300",
                            "--set", std::string("object.elements=") + elements});
    EXPECT_EQ(ended.status, 0) << ended.err;
    return json::parse(ended.out).at("mesh").at("blocks").get<double>();
  };
  const double linear = blocks("linear");
  EXPECT_GT(blocks("quadratic"), 1.3 * linear);
  EXPECT_EQ(blocks("quadratic"), blocks("quadratic-mean-dilatation"));
}

// Increments on the board and on the host against Newton's method on the same elements.
TEST_F(ElementsOfABody, HaveEveryLaw) {
  const std::vector<std::string> scene = {"object.mesh.nodes=117", "object.model=true",
                                          "dynamics=true", "refinement.passes=3"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), scene.begin(), scene.end());
    return run(more);
  };
  for (const char* elements : {"quadratic", "quadratic-mean-dilatation"}) {
    for (const char* law : {"corotational", "st-venant-kirchhoff", "neo-hookean-log",
                            "neo-hookean-isochoric", "fung"}) {
      const json summary = with({std::string("object.elements=") + elements,
                                 std::string("object.model.kind=") + law, "host.solver=cholesky"});
      EXPECT_GT(summary.at("force").at("largest").at("N"), 0) << law;
      EXPECT_LT(summary.at("accuracy").at("force_worst_rel"), 1e-3) << elements << law;
    }
  }
  const json board = with({"object.elements=quadratic", "object.model.kind=neo-hookean-log",
                           "object.model.matrix.renew_every=2", "fidelity.host=untimed"});
  EXPECT_GT(board.at("force").at("largest").at("N"), 0);
  EXPECT_LT(board.at("accuracy").at("force_worst_rel"), 1e-3);
}

TEST_F(ElementsOfABody, MoveByExplicitSteps) {
  const json summary = run({kMean[0], "object.mesh.nodes=117", "host.solver=explicit",
                            "dynamics.rayleigh_stiffness=0 s", "object.model=true",
                            "object.model.kind=neo-hookean-log"});
  EXPECT_GT(summary.at("force").at("largest").at("N"), 0);
}

TEST_F(ElementsOfABody, RefuseWhatIsMadeOfLinearOnes) {
  expect_refused({kMean[0], "host.solver=explicit", "dynamics.rayleigh_stiffness=0 s",
                  "object.model.kind=mass-spring"},
                 "springs run along the edges of linear tetrahedra");
}

TEST_F(ElementsOfABody, AnUnknownKindIsRefusedWithTheNearestName) {
  expect_refused({"object.elements=quadratik"}, "quadratic");
  expect_refused({"object.elements=quadratic", "object.mesh.nodes=9"},
                 "a quadratic tetrahedron has 10");
}

TEST_F(ElementsOfABody, ExportTenNodesAndTheirMatrices) {
  const Ended ended = command("export", {kMean[0], "object.mesh.nodes=117"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(read(place_.path() / "out/K.mtx"), StartsWith("%%MatrixMarket"));
  EXPECT_TRUE(std::filesystem::exists(place_.path() / "out/mesh.vtu"));
}

TEST_F(ElementsOfABody, MeshShowsThem) {
  const Ended ended = hvp(place_.path(), {"mesh", "sphere", "--nodes", "500", "--elements",
                                          "quadratic", "--out", "mesh.vtu"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("(500 wanted)"));
  const Ended mean = hvp(place_.path(), {"mesh", "sphere", "--nodes", "500", "--elements",
                                         "quadratic-mean-dilatation"});
  EXPECT_EQ(mean.status, 0) << mean.err;
  EXPECT_THAT(ended.out, HasSubstr(mean.out.substr(0, mean.out.find('\n'))));
  const Ended wrong =
      hvp(place_.path(), {"mesh", "sphere", "--nodes", "500", "--elements", "cubic"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(
      wrong.err,
      HasSubstr("--elements cubic: expected linear, quadratic or quadratic-mean-dilatation"));
}

}  // namespace
}  // namespace hvp::cli::elements_test
