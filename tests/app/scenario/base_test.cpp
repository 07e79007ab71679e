// A scenario that states what differs from another one.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/scenario/files.h"
#include "app/scenario/writer.h"
#include "tests/app/scenario/read_toy.h"
#include "tests/app/scratch_directory.h"

namespace hvp::scenario::base_test {
namespace {

// Files of their own, of which s.toml is read.
class Base : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories((place_.path() / name).parent_path());
    std::ofstream(place_.path() / name, std::ios::binary) << text;
  }
  toy::Scene read_scene(const std::vector<std::string>& overrides = {}) {
    const Document document = Document::load(place_.path() / "s.toml", overrides);
    toy::Scene scene;
    read(document, scene);
    resolve_files(document, scene);
    return scene;
  }
  // Without the folder.
  std::string error() {
    try {
      read_scene();
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

constexpr const char* kBase = R"(
title = "a base"
[object]
density = "900 kg/m3"
young = "5 kPa"
[host]
copy_rate = "1 Gflop/s"
[host.jitter]
[[contacts]]
depth = "1 mm"
[[contacts]]
depth = "2 mm"
)";

TEST_F(Base, HasWhatIsNotStated) {
  write("b.toml", kBase);
  write("s.toml", "base = 'b.toml'\n[object]\nyoung = '8 kPa'\n");
  const toy::Scene scene = read_scene();
  EXPECT_EQ(scene.title, "a base");
  EXPECT_EQ(scene.object.density, 900);
  EXPECT_EQ(scene.object.young, 8e3);
  EXPECT_EQ(scene.host.copy_rate, 1e9);
  EXPECT_TRUE(scene.host.jitter);
  EXPECT_EQ(scene.contacts.size(), 2U);
}

TEST_F(Base, GivesTheRunOfTheWholeScenario) {
  write("b.toml", kBase);
  write("s.toml", "base = 'b.toml'\ntitle = 'x'\n");
  toy::Scene whole = read_scene();
  write("s.toml", std::string(kBase).replace(1, 16, "title = 'x'"));
  EXPECT_EQ(resolved(whole), resolved(read_scene()));
}

TEST_F(Base, IsUnderListsAndEffectsThatAreStated) {
  write("b.toml", kBase);
  write("s.toml", "base = 'b.toml'\n[host]\njitter = false\n[[contacts]]\ndepth = '5 mm'\n");
  const toy::Scene scene = read_scene();
  EXPECT_FALSE(scene.host.jitter);
  EXPECT_EQ(scene.host.copy_rate, 1e9);
  ASSERT_EQ(scene.contacts.size(), 1U);
  EXPECT_EQ(scene.contacts[0].depth, 5e-3);
}

TEST_F(Base, HasABaseItself) {
  write("b.toml", kBase);
  write("deep/c.toml", "base = '../b.toml'\ntitle = 'c'\n[object]\nyoung = '6 kPa'\n");
  write("s.toml", "base = 'deep/c.toml'\ntitle = 's'\n");
  const toy::Scene scene = read_scene();
  EXPECT_EQ(scene.title, "s");
  EXPECT_EQ(scene.object.young, 6e3);
  EXPECT_EQ(scene.object.density, 900);
}

TEST_F(Base, IsUnderTheCommandLine) {
  write("b.toml", kBase);
  write("s.toml", "base = 'b.toml'\ntitle = 's'\n");
  EXPECT_EQ(read_scene({"title=t"}).title, "t");
  EXPECT_EQ(read_scene({"host.jitter=false"}).host.jitter.has_value(), false);
}

TEST_F(Base, HasFilesInItsOwnFolder) {
  write("deep/body.stl", "solid");
  write("deep/b.toml",
        "title = 'b'\n[object]\nsurface = 'body.stl'\n[[contacts]]\ndepth = '1 mm'\n");
  write("s.toml", "base = 'deep/b.toml'\ntitle = 's'\n");
  EXPECT_EQ(read_scene().object.surface.path, (place_.path() / "deep/body.stl").string());
}

// What the base says of its own kind goes with that.
TEST_F(Base, IsLeftBehindWhereAnotherKindIsChosen) {
  enum class Kind { ball, box };
  struct Body {
    Kind kind = Kind::ball;
    double radius = 1;
    void declare(config::Visitor& v) {
      const auto of_kind =
          v.variant("kind", kind, {{"ball", Kind::ball}, {"box", Kind::box}}, {"what it is"});
      of_kind.only({Kind::ball}, [&] {
        v.quantity("radius", radius, config::Dimension::length, {}, {"of the ball"});
      });
    }
  };
  write("b.toml", "kind = 'ball'\nradius = '3 m'\n");
  write("s.toml", "base = 'b.toml'\nkind = 'box'\n");
  Body body;
  read(Document::load(place_.path() / "s.toml"), body);
  EXPECT_EQ(body.kind, Kind::box);
  EXPECT_EQ(body.radius, 1);
  write("s.toml", "base = 'b.toml'\nkind = 'box'\nradius = '2 m'\n");
  EXPECT_THROW(read(Document::load(place_.path() / "s.toml"), body), SourceError);
}

TEST_F(Base, IsNamedWithTheLineThatIsWrong) {
  write("b.toml", "title = 'b'\n[object]\ndensity = '-1 kg/m3'\n");
  write("s.toml", "base = 'b.toml'\n");
  EXPECT_EQ(error().substr(0, 25), "b.toml:3: object.density:");
  write("b.toml", "title = \n");
  EXPECT_EQ(error().substr(0, 9), "b.toml:1:");
  // What the scenario says itself comes first.
  write("b.toml", "title = 'b'\n[object]\ndensity = '-1 kg/m3'\n");
  write("s.toml", "base = 'b.toml'\n\n\n\n\n[object]\nyoung = 3\n");
  EXPECT_EQ(error().substr(0, 23), "s.toml:7: object.young:");
}

TEST_F(Base, ThatIsNoneIsRefused) {
  write("s.toml", "title = 'x'\nbase = 'none.toml'\n");
  EXPECT_EQ(error(), "s.toml:2: base: none.toml: no such file: expected a scenario");
  write("s.toml", "base = 3\n");
  EXPECT_EQ(error(), "s.toml:1: base: expected the name of a scenario in quotes, found 3");
  write("s.toml", "base = ''\n");
  EXPECT_EQ(error(), "s.toml:1: base: expected the name of a scenario in quotes, found \"\"");
}

TEST_F(Base, ThatGoesRoundOrOnAndOnIsRefused) {
  write("b.toml", "base = 's.toml'\n");
  write("s.toml", "base = 'b.toml'\ntitle = 'x'\n");
  EXPECT_EQ(error(), "b.toml:1: base: expected no circle: s.toml already stands on this one");
  write("s.toml", "base = '0.toml'\n");
  for (int i = 0; i < 10; ++i) {
    write(std::to_string(i) + ".toml", "base = '" + std::to_string(i + 1) + ".toml'\n");
  }
  EXPECT_EQ(error(), "7.toml:1: base: expected at most 9 scenarios on one another");
}

}  // namespace
}  // namespace hvp::scenario::base_test
