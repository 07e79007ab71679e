#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// Bodies with parts of another material, as a user runs them.
namespace hvp::cli::regions_test {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

// A cube of 8 mm round the point (0, 0, 4 mm), as STL in millimetres; without its last facet it is
// open.
std::string cube_stl(bool closed) {
  const double corner[8][3] = {{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0},
                               {-4, -4, 8}, {4, -4, 8}, {4, 4, 8}, {-4, 4, 8}};
  const int facets[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                             {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
  std::string text = "solid lump\n";
  for (int i = 0; i < (closed ? 12 : 11); ++i) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int n : facets[i]) {
      text += "vertex";
      for (const double x : corner[n]) text += " " + std::to_string(x);
      text += "\n";
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid lump\n";
}

class Regions : public ::testing::Test {
 protected:
  // The small scene with these tables [[object.region]], from line 16 on.
  Ended run(const std::string& regions, const std::vector<std::string>& changes = {},
            const std::string& command = "run") {
    std::string text = kSmallScene;
    const std::string anchor = "[[object.anchor]]";
    text.replace(text.find(anchor), anchor.size(), regions + anchor);
    write(place_.path() / "s.toml", text);
    std::vector<std::string> arguments = {command, "s.toml"};
    if (command != "explain") arguments.insert(arguments.end(), {"--out", "out"});
    for (const std::string& change : changes) {
      arguments.emplace_back("--set");
      arguments.push_back(change);
    }
    return hvp(place_.path(), arguments);
  }
  json summary(const std::string& regions, const std::vector<std::string>& changes = {}) {
    const Ended ended = run(regions, changes);
    EXPECT_LT(ended.status, 2) << ended.err;
    out_ = ended.out;
    return json::parse(read(place_.path() / "out/summary.json"));
  }
  std::string frames() const { return read(place_.path() / "out/frames.csv"); }
  static double force(const json& summary) { return summary.at("force").at("largest").at("N"); }

  ScratchDirectory place_;
  std::string out_;
};

const char* const kLump =
    "[[object.region]]\nname = \"lump\"\ncentre = [\"0 mm\", \"0 mm\", \"5 mm\"]\n"
    "radius = \"4 mm\"\nyoung_modulus = \"80 kPa\"\ndensity = \"1200 kg/m3\"\n";

TEST_F(Regions, AreSaidWithTheirElementsVolumeAndMass) {
  const json s = summary(kLump);
  const json& regions = s.at("mesh").at("regions");
  ASSERT_EQ(regions.size(), 2U);
  EXPECT_EQ(regions[0].at("name"), "object.material");
  EXPECT_EQ(regions[1].at("name"), "lump");
  EXPECT_EQ(regions[0].at("elements").get<int>() + regions[1].at("elements").get<int>(),
            s.at("mesh").at("tetrahedra").get<int>());
  const double rest = regions[0].at("volume_m3");
  const double lump = regions[1].at("volume_m3");
  EXPECT_NEAR(rest + lump, 8e-6, 1e-15);  // the box
  EXPECT_NEAR(regions[0].at("mass_kg"), 1000 * rest, 1e-12);
  EXPECT_NEAR(regions[1].at("mass_kg"), 1200 * lump, 1e-12);
  EXPECT_NEAR(regions[1].at("volume_share"), lump / 8e-6, 1e-9);
  // A ball of 4 mm has 268 mm³.
  EXPECT_NEAR(lump, 268e-9, 130e-9);
  // What it does not state is the body's.
  EXPECT_EQ(regions[1].at("poisson_ratio"), 0.3);
  EXPECT_EQ(regions[1].at("young_modulus_Pa"), 80e3);
  EXPECT_THAT(out_, HasSubstr("lump: "));
  EXPECT_THAT(out_, HasSubstr("80 kPa"));
  EXPECT_THAT(run(kLump, {}, "explain").out, HasSubstr("lump: "));
}

TEST_F(Regions, OfTheBodysMaterialChangeNoFrame) {
  summary("");
  const std::string uniform = frames();
  EXPECT_FALSE(
      json::parse(read(place_.path() / "out/summary.json")).at("mesh").contains("regions"));
  summary("[[object.region]]\ncentre = [\"0 mm\", \"0 mm\", \"5 mm\"]\nradius = \"4 mm\"\n");
  EXPECT_EQ(frames(), uniform);
  // One that has all, of the whole body's other modulus, is a body of that modulus.
  summary("", {"object.material.young_modulus=20kPa"});
  const std::string stiffer = frames();
  summary("[[object.region]]\nradius = \"1 m\"\nyoung_modulus = \"20 kPa\"\n");
  EXPECT_EQ(frames(), stiffer);
  EXPECT_THAT(out_, HasSubstr("no element is left, the regions have all"));
}

TEST_F(Regions, AStifferLumpIsFelt) {
  double before = 0;
  for (const char* modulus : {"1kPa", "10kPa", "40kPa", "100kPa"}) {
    const json s = summary(
        kLump, {"host.solver=cholesky", std::string("object.region[0].young_modulus=") + modulus});
    EXPECT_GT(force(s), before);
    before = force(s);
  }
}

TEST_F(Regions, ASurfaceIsTheBoxThatItEncloses) {
  write(place_.path() / "lump.stl", cube_stl(true));
  const json by_box = summary(
      "[[object.region]]\nname = \"lump\"\nshape = \"box\"\n"
      "low_corner = [\"-4 mm\", \"-4 mm\", \"0 mm\"]\nhigh_corner = [\"4 mm\", \"4 mm\", \"8 "
      "mm\"]\n"
      "young_modulus = \"80 kPa\"\n");
  const std::string expected = frames();
  const char* const surface =
      "[[object.region]]\nname = \"lump\"\nshape = \"surface\"\nsurface = \"lump.stl\"\n"
      "young_modulus = \"80 kPa\"\n";
  EXPECT_EQ(summary(surface).at("mesh"), by_box.at("mesh"));
  EXPECT_EQ(frames(), expected);
  // The results repeat the run by themselves.
  EXPECT_TRUE(std::filesystem::exists(place_.path() / "out/scenario.resolved.region0.stl"));
  const Ended again = hvp(place_.path(), {"run", "out/scenario.resolved.toml", "--out", "again"});
  EXPECT_LT(again.status, 2) << again.err;
  EXPECT_EQ(read(place_.path() / "again/frames.csv"), expected);
  // A later run without the surface takes its copy away.
  summary("");
  EXPECT_FALSE(std::filesystem::exists(place_.path() / "out/scenario.resolved.region0.stl"));
}

TEST_F(Regions, GoIntoTheFilesOfOthers) {
  EXPECT_EQ(run(kLump, {}, "export").status, 0);
  EXPECT_THAT(read(place_.path() / "out/mesh.vtu"), HasSubstr("Name=\"region\""));
  EXPECT_LT(run(kLump, {}).status, 2);
  EXPECT_THAT(read(place_.path() / "out/deformation_000000.vtu"), HasSubstr("Name=\"region\""));
  EXPECT_LT(run("", {}).status, 2);
  EXPECT_THAT(read(place_.path() / "out/deformation_000000.vtu"),
              Not(HasSubstr("Name=\"region\"")));
}

// A million times as stiff as what holds it: the words say so, and what helps is tried.
TEST_F(Regions, AContrastBeyondTheWordsIsFlagged) {
  const json s = summary(
      "[[object.region]]\nshape = \"half-space\"\nnormal = [0, 0, -1]\n"
      "young_modulus = \"10 GPa\"\n");
  EXPECT_THAT(s.at("stability").at("flags"), Contains("zero-diagonal"));
  EXPECT_THAT(s.at("stability").at("flags"), Not(IsEmpty()));
  EXPECT_THAT(out_, HasSubstr("remed"));
}

struct Wrong {
  std::string regions;
  std::string start;
  std::string rest;
};

TEST_F(Regions, ThatCannotBeAreRefused) {
  write(place_.path() / "open.stl", cube_stl(false));
  const std::vector<Wrong> all = {
      {"shape = \"cube\"\n", "s.toml:17: object.region[0].shape: ", "\"half-space\""},
      {"radius = \"-1 mm\"\n", "s.toml:17: object.region[0].radius: ", "out of range"},
      {"radius = 3\n", "s.toml:17: object.region[0].radius: ", "unit"},
      {"name = \"a\"\n", "s.toml:16: object.region[0].radius: ", "missing"},
      {"shape = \"half-space\"\nnormal = [0, 0, 0]\n",
       "s.toml:18: object.region[0].normal: ", "length zero"},
      {"shape = \"box\"\nhigh_corner = [\"-1 mm\", \"1 mm\", \"1 mm\"]\n",
       "s.toml:18: object.region[0].high_corner: ", "below low_corner"},
      {"radius = \"4 mm\"\nfraction = 0.2\n",
       "s.toml:18: object.region[0].fraction: ", "unknown key"},
      {"shape = \"box\"\nradius = \"4 mm\"\n",
       "s.toml:18: object.region[0].radius: ", "belongs to shape = \"sphere\" only"},
      {"radius = \"4 mm\"\npoisson_ratio = 0.5\n",
       "s.toml:18: object.region[0].poisson_ratio: ", "out of range"},
      {"radius = \"4 mm\"\nyoung_modulus = \"0 Pa\"\n",
       "s.toml:18: object.region[0].young_modulus: ", "out of range"},
      {"radius = \"4 mm\"\n[[object.region.prony]]\nshare = 0.5\n",
       "s.toml:18: object.region[0].prony: ", "unknown key"},
      {"radius = \"1 mm\"\ncentre = [\"90 mm\", \"0 mm\", \"0 mm\"]\n",
       "s.toml:16: object.region[0]: ", "the centroid of none of the"},
      {"radius = \"1 mm\"\n[[object.region]]\nradius = \"1 m\"\n",
       "s.toml:16: object.region[0]: ", "none of"},
      {"radius = \"9 mm\"\n[[object.region]]\nradius = \"1 m\"\n",
       "s.toml:16: object.region[0]: ", "listed later"},
      {"name = \"a\"\nradius = \"4 mm\"\n[[object.region]]\nname = \"a\"\nradius = \"3 mm\"\n",
       "s.toml:20: object.region[1].name: ", "has this name too"},
      {"shape = \"surface\"\nsurface = \"none.stl\"\n",
       "s.toml:18: object.region[0].surface: ", "none.stl"},
      {"shape = \"surface\"\nsurface = \"open.stl\"\n",
       "s.toml:18: object.region[0].surface: ", "open"}};
  for (const Wrong& wrong : all) {
    const Ended ended = run("[[object.region]]\n" + wrong.regions);
    EXPECT_EQ(ended.status, 2) << wrong.regions;
    EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
    EXPECT_THAT(ended.err, StartsWith(wrong.start));
    EXPECT_THAT(ended.err, HasSubstr(wrong.rest));
    EXPECT_FALSE(std::filesystem::exists(place_.path() / "out"));
  }
}

TEST_F(Regions, AreNoBodyToFit) {
  run(kLump);
  write(place_.path() / "log.csv", "time_s,depth_m,force_N\n0,0,0\n1,0.001,0.1\n2,0.002,0.2\n");
  const Ended ended =
      hvp(place_.path(), {"fit", "log.csv", "--model", "tissue", "--scenario", "s.toml"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, HasSubstr("expected a body of one material"));
}

}  // namespace
}  // namespace hvp::cli::regions_test
