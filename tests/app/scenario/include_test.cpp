// Files that a scenario includes: under its own keys and over its base.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/scenario/files.h"
#include "tests/app/scenario/read_toy.h"
#include "tests/app/scratch_directory.h"

namespace hvp::scenario::include_test {
namespace {

// Files of their own, of which s.toml is read.
class Included : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) {
    const std::filesystem::path file = place_.path() / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }
  toy::Scene read_scene(const std::vector<std::string>& overrides = {},
                        const std::vector<std::filesystem::path>& includes = {}) {
    const Document document = Document::load(place_.path() / "s.toml", overrides, includes);
    toy::Scene scene;
    read(document, scene);
    resolve_files(document, scene);
    return scene;
  }
  // Without the folder.
  std::string error(const std::vector<std::filesystem::path>& includes = {}) {
    try {
      read_scene({}, includes);
    } catch (const SourceError& e) {
      std::string text = e.what();
      const std::string folder = place_.path().string() + "/";
      for (auto at = text.find(folder); at != std::string::npos; at = text.find(folder)) {
        text.erase(at, folder.size());
      }
      return text;
    }
    return "no error";
  }

  ScratchDirectory place_;
};

constexpr const char* kBase =
    "title = 'b'\n[object]\ndensity = '900 kg/m3'\nyoung = '5 kPa'\n[host.jitter]\n[[contacts]]\n"
    "depth = '1 mm'\n";

TEST_F(Included, LiesOverTheBaseAndUnderTheScenario) {
  write("b.toml", kBase);
  write("f.toml", "title = 'f'\n[object]\nyoung = '6 kPa'\n");
  write("s.toml", "include = 'f.toml'\nbase = 'b.toml'\ntitle = 's'\n");
  const toy::Scene scene = read_scene();
  EXPECT_EQ(scene.title, "s");
  EXPECT_EQ(scene.object.young, 6e3);
  EXPECT_EQ(scene.object.density, 900);
  EXPECT_TRUE(scene.host.jitter);
  EXPECT_EQ(read_scene({"object.young=7 kPa"}).object.young, 7e3);
}

TEST_F(Included, MayBeAListOfWhichTheLastCountsMost) {
  write("f.toml", "title = 'f'\n[object]\nyoung = '6 kPa'\n[[contacts]]\ndepth = '1 mm'\n");
  write("g.toml", "title = 'g'\n[object]\ndensity = '800 kg/m3'\n");
  write("s.toml", "include = ['f.toml', 'g.toml']\n");
  EXPECT_EQ(read_scene().title, "g");
  EXPECT_EQ(read_scene().object.young, 6e3);
  EXPECT_EQ(read_scene().object.density, 800);
  write("s.toml", "include = ['g.toml', 'f.toml']\n");
  EXPECT_EQ(read_scene().title, "f");
  write("s.toml", "include = []\ntitle = 's'\n[[contacts]]\ndepth = '1 mm'\n");
  EXPECT_EQ(read_scene().title, "s");
}

TEST_F(Included, OfTheBaseLiesUnderAllOfTheScenario) {
  write("f.toml", "title = 'f'\n[object]\nyoung = '6 kPa'\n");
  write("g.toml", "[object]\nyoung = '7 kPa'\n");
  write("b.toml", std::string("include = 'g.toml'\n") + kBase);
  write("s.toml", "base = 'b.toml'\n");
  EXPECT_EQ(read_scene().object.young, 5e3);
  write("b.toml", "include = 'g.toml'\ntitle = 'b'\n[[contacts]]\ndepth = '1 mm'\n");
  EXPECT_EQ(read_scene().object.young, 7e3);
  write("s.toml", "base = 'b.toml'\ninclude = 'f.toml'\n");
  EXPECT_EQ(read_scene().object.young, 6e3);
}

TEST_F(Included, TakesEffectsOutAndPutsThemIn) {
  write("b.toml", kBase);
  write("off.toml", "[host]\njitter = false\n");
  write("on.toml", "[host.jitter]\n");
  write("s.toml", "base = 'b.toml'\ninclude = 'off.toml'\n");
  EXPECT_FALSE(read_scene().host.jitter);
  write("s.toml", "base = 'b.toml'\ninclude = ['off.toml', 'on.toml']\n");
  EXPECT_TRUE(read_scene().host.jitter);
  write("s.toml", "base = 'b.toml'\ninclude = 'on.toml'\n[host]\njitter = false\n");
  EXPECT_FALSE(read_scene().host.jitter);
}

// The base's base does not bring back what the base takes out.
TEST_F(Included, LeavesOutWhatAnyFileAboveTakesOut) {
  write("b.toml", kBase);
  write("c.toml", "base = 'b.toml'\n[host.jitter]\n");
  write("s.toml", "base = 'c.toml'\n[host]\njitter = false\n");
  EXPECT_FALSE(read_scene().host.jitter);
}

TEST_F(Included, StartsPathsFromItsOwnFolder) {
  write("deep/body.stl", "solid");
  write("deep/more.toml", "[[contacts]]\ndepth = '1 mm'\n");
  write("deep/f.toml", "include = 'more.toml'\ntitle = 'f'\n[object]\nsurface = 'body.stl'\n");
  write("s.toml", "include = 'deep/f.toml'\n");
  EXPECT_EQ(read_scene().object.surface.path, (place_.path() / "deep/body.stl").string());
  EXPECT_EQ(read_scene().contacts.size(), 1U);
}

TEST_F(Included, OfTheCommandLineLiesOverTheScenario) {
  const auto f = write("deep/f.toml", "title = 'f'\n[object]\nyoung = '6 kPa'\n");
  const auto g = write("g.toml", "title = 'g'\n");
  write("s.toml", kBase);
  EXPECT_EQ(read_scene({}, {f}).title, "f");
  EXPECT_EQ(read_scene({}, {f}).object.density, 900);
  EXPECT_EQ(read_scene({}, {f, g}).title, "g");
  EXPECT_EQ(read_scene({}, {f, g}).object.young, 6e3);
  EXPECT_EQ(read_scene({"title=t"}, {f, g}).title, "t");
  // Overrides start from the scenario.
  write("body.stl", "solid");
  EXPECT_EQ(read_scene({"object.surface=body.stl"}, {f}).object.surface.path,
            (place_.path() / "body.stl").string());
}

TEST_F(Included, IsNamedWithTheLineThatIsWrong) {
  const auto f = write("f.toml", "title = 'f'\n[object]\ndensity = '-1 kg/m3'\n");
  write("s.toml", std::string("include = 'f.toml'\n") + "title = 's'\n[[contacts]]\n");
  EXPECT_EQ(error().substr(0, 25), "f.toml:3: object.density:");
  write("s.toml", kBase);
  EXPECT_EQ(error({f}).substr(0, 25), "f.toml:3: object.density:");
  write("s.toml", "title = 's'\n[object]\nyoung = 3\n");
  EXPECT_EQ(error({write("g.toml", "title = 'g'\n")}).substr(0, 23), "s.toml:3: object.young:");
  write("s.toml", "include = 'f.toml'\n");
  write("f.toml", "title = \n");
  EXPECT_EQ(error().substr(0, 9), "f.toml:1:");
}

TEST_F(Included, ThatIsNoneIsRefused) {
  write("f.toml", "title = 'f'\n");
  write("s.toml", "title = 'x'\ninclude = ['f.toml',\n 'none.toml']\n");
  EXPECT_EQ(error(),
            "s.toml:3: include[1]: none.toml: no such file: expected a file of a scenario's keys");
  write("s.toml", "include = 3\n");
  EXPECT_EQ(error(),
            "s.toml:1: include: expected the name of a file of a scenario's keys in quotes, or a "
            "list of such, found 3");
  write("s.toml", "include = ['']\n");
  EXPECT_EQ(error(),
            "s.toml:1: include[0]: expected the name of a file of a scenario's keys in quotes, or "
            "a list of such, found \"\"");
  EXPECT_EQ(error({place_.path() / "none.toml"}), "none.toml: no such file: expected a scenario");
}

TEST_F(Included, ThatGoesRoundOrOnAndOnIsRefused) {
  write("s.toml", "include = 's.toml'\n");
  EXPECT_EQ(error(), "s.toml:1: include: expected no circle: s.toml already has this one below it");
  write("s.toml", "base = 'b.toml'\n");
  write("b.toml", "include = 's.toml'\n");
  EXPECT_EQ(error(), "b.toml:1: include: expected no circle: s.toml already has this one below it");
  for (int i = 0; i < 9; ++i) {
    const std::string next = "'" + std::to_string(i + 1) + ".toml'";
    write(std::to_string(i) + ".toml", "include = [" + next + ", " + next + "]\n");
  }
  write("9.toml", "title = 'end'\n");
  write("s.toml", "include = '0.toml'\n");
  EXPECT_EQ(error(), "7.toml:1: include[1]: expected at most 9 scenarios on one another");
  write("7.toml", "title = 'end'\n");
  EXPECT_NE(error().find(": expected at most 100 files in all"), std::string::npos) << error();
}

// From two files is no circle.
TEST_F(Included, MayComeTwice) {
  write("f.toml", "title = 'f'\n");
  write("b.toml", std::string("include = 'f.toml'\n") + kBase);
  write("s.toml", "base = 'b.toml'\ninclude = ['f.toml', 'f.toml']\n");
  EXPECT_EQ(read_scene().title, "f");
}

}  // namespace
}  // namespace hvp::scenario::include_test
