#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// The same scenario gives the same bytes, whoever runs it and where.
namespace hvp::cli::repeat_test {
namespace {

namespace fs = std::filesystem;

void expect_same_results(const fs::path& a, const fs::path& b) {
  ASSERT_EQ(names(a), names(b));
  for (const std::string& name : names(a)) {
    if (name == "performance.json" || name.ends_with(".png")) continue;
    EXPECT_TRUE(read(a / name) == read(b / name)) << name;
  }
}

void run(const fs::path& folder, const std::vector<std::string>& arguments) {
  std::vector<std::string> all = {"run"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  const Ended ended = hvp(folder, all);
  EXPECT_EQ(ended.status, 0) << ended.err;
}

TEST(Repeat, TwoPlacesGiveTheSameBytes) {
  const ScratchDirectory a, b;
  fs::create_directories(b.path() / "deep/er");
  write(a.path() / "s.toml", kSmallScene);
  write(b.path() / "deep/other name.toml", kSmallScene);
  run(a.path(), {"s.toml", "--out", "out", "--set", "dynamics=true", "--trace-registers"});
  run(b.path() / "deep/er", {"../other name.toml", "--out", b.path() / "x", "--quiet", "--set",
                             "dynamics=true", "--trace-registers"});
  expect_same_results(a.path() / "out", b.path() / "x");
}

TEST(Repeat, TheResolvedScenarioGivesTheRunAgain) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", kSmallScene);
  run(place.path(), {"s.toml", "--out", "a", "--set", "dynamics=true", "--set",
                     "loads.gravity=true", "--set", "solver.iterations=12"});
  run(place.path(), {"a/scenario.resolved.toml", "--out", "b"});
  expect_same_results(place.path() / "a", place.path() / "b");
}

TEST(Repeat, TheResolvedScenarioBringsItsSurface) {
  const ScratchDirectory place, elsewhere;
  fs::create_directories(place.path() / "bodies");
  fs::copy_file(scenario("surfaces/bean.stl"), place.path() / "bodies/bean.STL");
  std::string text = kSmallScene;
  const std::string box = "shape = \"box\"\nsize = [\"20 mm\", \"20 mm\", \"20 mm\"]\nnodes = 60";
  text.replace(text.find(box), box.size(),
               "shape = \"surface\"\nsurface = \"bodies/bean.STL\"\nnodes = 200");
  write(place.path() / "s.toml", text);
  run(place.path(), {"s.toml", "--out", elsewhere.path() / "a"});
  fs::remove_all(place.path());
  run(elsewhere.path(), {"a/scenario.resolved.toml", "--out", "b"});
  expect_same_results(elsewhere.path() / "a", elsewhere.path() / "b");
  // Into its own folder too, where the surface is source and result.
  run(elsewhere.path(), {"a/scenario.resolved.toml", "--out", "a"});
  expect_same_results(elsewhere.path() / "a", elsewhere.path() / "b");
  EXPECT_EQ(read(elsewhere.path() / "a/scenario.resolved.stl"),
            read(scenario("surfaces/bean.stl")));
  // A body without a file leaves none behind.
  write(elsewhere.path() / "s.toml", kSmallScene);
  run(elsewhere.path(), {"s.toml", "--out", "a"});
  EXPECT_FALSE(fs::exists(elsewhere.path() / "a/scenario.resolved.stl"));
}

TEST(Repeat, TheResolvedScenarioBringsItsDevice) {
  const ScratchDirectory place, elsewhere;
  std::string device = read(scenario("../devices/EP2S60.toml"));
  const std::string name = "name = \"EP2S60\"";
  device.replace(device.find(name), name.size(), "name = \"my own\"");
  write(place.path() / "own.toml", device);
  write(place.path() / "s.toml", kSmallScene);
  run(place.path(),
      {"s.toml", "--out", elsewhere.path() / "a", "--set", "accelerator.device=own.toml"});
  fs::remove_all(place.path());
  run(elsewhere.path(), {"a/scenario.resolved.toml", "--out", "b"});
  expect_same_results(elsewhere.path() / "a", elsewhere.path() / "b");
  EXPECT_THAT(read(elsewhere.path() / "b/summary.json"), testing::HasSubstr("\"my own\""));
  EXPECT_EQ(read(elsewhere.path() / "b/scenario.resolved.device.toml"), device);
  // A built-in device leaves none behind.
  write(elsewhere.path() / "s.toml", kSmallScene);
  run(elsewhere.path(), {"s.toml", "--out", "b"});
  EXPECT_FALSE(fs::exists(elsewhere.path() / "b/scenario.resolved.device.toml"));
}

}  // namespace
}  // namespace hvp::cli::repeat_test
