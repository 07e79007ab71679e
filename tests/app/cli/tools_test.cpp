#include <sstream>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// The commands beside `run`.
namespace hvp::cli::tools_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Mesh, ShowsItsQualityAndWritesTheFile) {
  const ScratchDirectory place;
  const Ended ended =
      hvp(place.path(), {"mesh", "box", "--nodes", "80", "--size", "30 mm", "--out", "a/m.vtu"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  for (const char* word : {"(80 wanted)", "tetrahedra", "volume             27 cm3", "dihedral",
                           "aspect ratio", "smallest det J", "a/m.vtu"}) {
    EXPECT_THAT(ended.out, HasSubstr(word));
  }
  EXPECT_THAT(names(place.path() / "a"), ElementsAre("m.vtu"));
}

TEST(Mesh, TakesAFilesUnit) {
  const ScratchDirectory place;
  const std::string bean = scenario("surfaces/bean.stl").string();
  const Ended mm = hvp(place.path(), {"mesh", bean, "--nodes", "200"});
  const Ended cm = hvp(place.path(), {"mesh", bean, "--nodes", "200", "--unit", "10 mm"});
  const auto volume = [](const Ended& ended) {
    for (const std::string& line : lines(ended.out)) {
      std::string word;
      double value = 0;
      std::istringstream stream(line);
      if (stream >> word >> value && word == "volume") return value;
    }
    return 0.0;
  };
  ASSERT_GT(volume(mm), 0) << mm.err;
  EXPECT_NEAR(volume(cm) / volume(mm), 1000, 0.01);
}

TEST(Explain, ListsWhatIsThereAndWhatIsNot) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", kSmallScene);
  const Ended ended = hvp(place.path(), {"explain", "s.toml"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, ::testing::ContainsRegex("dynamics +absent"));
  EXPECT_THAT(ended.out, ::testing::ContainsRegex("reference +built"));
  EXPECT_THAT(ended.out, ::testing::ContainsRegex("M4K +[0-9]+ of 255"));
  EXPECT_THAT(names(place.path()), ElementsAre("s.toml"));
}

TEST(Explain, GivesNoTimeToAPartThatTakesNone) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", kSmallScene);
  const auto explained = [&](const std::string& key) {
    return hvp(place.path(), {"explain", "s.toml", "--set", key}).out;
  };
  using ::testing::ContainsRegex;
  using ::testing::Not;
  for (const char* step : {"form b [(]without contact[)] +0 ns", "send b +0 ns", "\n  solve +0 ns",
                           "receive U +0 ns"}) {
    EXPECT_THAT(explained("frames=1"), Not(ContainsRegex(step)));
  }
  EXPECT_THAT(explained("fidelity.accelerator=untimed"), ContainsRegex("\n  solve +0 ns"));
  EXPECT_THAT(explained("fidelity.bus=untimed"), ContainsRegex("send b +0 ns"));
  EXPECT_THAT(explained("fidelity.bus=untimed"), ContainsRegex("receive U +0 ns"));
  EXPECT_THAT(explained("fidelity.host=untimed"),
              ContainsRegex("form b [(]without contact[)] +0 ns"));
}

TEST(Explain, TellsWhatSeveralDevicesCost) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", kSmallScene);
  const Ended ended =
      hvp(place.path(), {"explain", "s.toml", "--set", "accelerator.several.devices=3"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, ::testing::ContainsRegex("accelerator.several +built"));
  EXPECT_THAT(ended.out, ::testing::ContainsRegex("device 3 +[0-9]+ nodes' rows"));
  EXPECT_THAT(ended.out, ::testing::ContainsRegex("clocks of links an iteration +[0-9]+"));
  EXPECT_THAT(ended.out, ::testing::ContainsRegex("speed-up over one device +1: 1.00 2: "));
}

TEST(Export, WritesTheSystem) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", kSmallScene);
  EXPECT_EQ(hvp(place.path(), {"export", "s.toml", "--out", "d", "--set", "dynamics=true"}).status,
            0);
  EXPECT_THAT(names(place.path() / "d"),
              ElementsAre("A.mtx", "K.mtx", "M.mtx", "b.mtx", "mesh.vtu"));
  // Static in the same folder: the step's matrix of before would be another body's.
  EXPECT_EQ(hvp(place.path(), {"export", "s.toml", "--out", "d"}).status, 0);
  EXPECT_THAT(names(place.path() / "d"), ElementsAre("K.mtx", "M.mtx", "b.mtx", "mesh.vtu"));
  EXPECT_THAT(read(place.path() / "d/K.mtx"),
              ::testing::StartsWith("%%MatrixMarket matrix coordinate real symmetric\n"));
}

TEST(Export, NeedsNoDeviceThatHoldsIt) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", kSmallScene);
  const Ended ended =
      hvp(place.path(), {"export", "s.toml", "--out", "d", "--set", "object.mesh.nodes=2000"});
  EXPECT_EQ(ended.status, 0) << ended.err;
}

TEST(Reference, IsTheWholePage) {
  const ScratchDirectory place;
  const Ended ended = hvp(place.path(), {"reference"});
  EXPECT_EQ(ended.status, 0);
  for (const char* word : {"# Scenario reference", "`[budget]`", "`period`", "`[dynamics]`"}) {
    EXPECT_THAT(ended.out, HasSubstr(word));
  }
}

}  // namespace
}  // namespace hvp::cli::tools_test
