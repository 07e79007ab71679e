#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// Where results go: --out, and what an earlier or a killed run left there.
namespace hvp::cli::folder_test {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class Folder : public ::testing::Test {
 protected:
  Folder() { write(place_.path() / "s.toml", kSmallScene); }

  Ended run(std::vector<std::string> more) {
    more.insert(more.begin(), {"run", "s.toml"});
    return hvp(place_.path(), more);
  }
  const fs::path& path() const { return place_.path(); }

 private:
  ScratchDirectory place_;
};

TEST_F(Folder, IsRunsAndTheScenarioByDefault) {
  const Ended ended = run({});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(fs::exists(path() / "runs/s/summary.json"));
}

// What the included file says counts more than the scenario and less than --set, and shows.
TEST_F(Folder, NamesWhatIsIncluded) {
  write(path() / "fitted.toml", "title = 'fitted'\nframes = 3\n");
  const Ended ended = run({"--include", "fitted.toml", "--set", "output.pictures=false"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  const fs::path results = path() / "runs/s+include=fitted.toml+output.pictures=false";
  const auto summary = nlohmann::json::parse(read(results / "summary.json"));
  EXPECT_EQ(summary.at("title"), "fitted [include=fitted.toml]");
  EXPECT_EQ(summary.at("frames_asked"), 3);
  const Ended wrong = run({"--include", "none.toml"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("none.toml: no such file: expected a scenario"));
}

TEST_F(Folder, HoldsTheResultsAndNothingElse) {
  ASSERT_EQ(run({"--out", "out"}).status, 0);
  EXPECT_THAT(
      names(path() / "out"),
      ElementsAre("deformation.pvd", "deformation_000000.vtu", "deformation_000010.vtu",
                  "deformation_000020.vtu", "deformation_000030.vtu", "frames.csv",
                  "performance.json", "scenario.resolved.toml", "summary.json", "trace.json"));
}

TEST_F(Folder, MayHaveSpacesAndAnyLetters) {
  const Ended ended = run({"--out", "a b/ü 'c'"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(fs::exists(path() / "a b/ü 'c'/summary.json"));
  EXPECT_THAT(ended.out, HasSubstr("Results in a b/ü 'c' "));
}

TEST_F(Folder, ThatIsAFileIsWrongInput) {
  write(path() / "file", "mine");
  for (const char* command : {"run", "export"}) {
    for (const char* out : {"file", "file/below"}) {
      const Ended ended = hvp(path(), {command, "s.toml", "--out", out});
      EXPECT_EQ(ended.status, 2);
      EXPECT_EQ(ended.out, "");
      EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
      EXPECT_THAT(ended.err, ::testing::StartsWith(std::string("--out ") + out));
      EXPECT_THAT(ended.err, HasSubstr("is a file: expected a folder"));
    }
  }
  EXPECT_EQ(read(path() / "file"), "mine");
}

TEST_F(Folder, ThatCannotBeCreatedIsWrongInput) {
  const Ended ended = run({"--out", "/proc/hvp"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, HasSubstr("--out /proc/hvp: cannot be created: "));
  EXPECT_EQ(lines(ended.err).size(), 1U);
}

TEST_F(Folder, IsClearedOfAnEarlierRunButOfNothingElse) {
  ASSERT_EQ(run({"--out", "out", "--trace-registers"}).status, 0);
  EXPECT_TRUE(fs::exists(path() / "out/registers.log"));
  for (const char* name :
       {"deformation.png", "latency.png", "deformation_000900.vtu", "deformation_000900.vtu.part",
        "summary.json.part", "notes.txt", "deformation_mine.vtu"}) {
    write(path() / "out" / name, "old");
  }
  ASSERT_EQ(run({"--out", "out", "--set", "output.deformation_every_frames=0"}).status, 0);
  EXPECT_THAT(names(path() / "out"),
              ElementsAre("deformation_mine.vtu", "frames.csv", "notes.txt", "performance.json",
                          "scenario.resolved.toml", "summary.json", "trace.json"));
}

TEST_F(Folder, KeepsAnEarlierRunWhenTheNewScenarioIsWrong) {
  ASSERT_EQ(run({"--out", "out"}).status, 0);
  const std::string summary = read(path() / "out/summary.json");
  EXPECT_EQ(run({"--out", "out", "--set", "object.mesh.nodes=3000"}).status, 2);
  EXPECT_EQ(read(path() / "out/summary.json"), summary);
}

// A killed run may leave files under final names only where they are complete.
TEST_F(Folder, TakesOneRunAtATime) {
  Program first(path(), {"run", "s.toml", "--out", "out", "--set", "frames=1000000", "--quiet"});
  while (!fs::exists(path() / "out/deformation_000010.vtu") && !first.ended()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const Ended second = run({"--out", "out"});
  EXPECT_EQ(second.status, 2);
  EXPECT_EQ(lines(second.err).size(), 1U) << second.err;
  EXPECT_THAT(second.err, HasSubstr("another run is writing into out"));
  EXPECT_FALSE(first.ended());
  first.kill();
  first.wait();
  EXPECT_EQ(run({"--out", "out"}).status, 0);
}

TEST_F(Folder, OfAKilledRunHasNoHalfFileAndTakesTheNextRun) {
  ASSERT_EQ(run({"--out", "out"}).status, 0);
  {
    Program killed(path(), {"run", "s.toml", "--out", "out", "--set", "frames=1000000",
                            "--trace-registers", "--quiet"});
    while (!fs::exists(path() / "out/deformation_000100.vtu") && !killed.ended()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    killed.kill();
    EXPECT_EQ(killed.wait().signal, SIGKILL);
  }
  const std::vector<std::string> left = names(path() / "out");
  for (const char* name :
       {"summary.json", "frames.csv", "trace.json", "registers.log", "deformation.pvd"}) {
    EXPECT_THAT(left, Not(Contains(name)));
  }
  for (const std::string& name : left) {
    if (!name.ends_with(".vtu")) continue;
    EXPECT_THAT(read(path() / "out" / name), ::testing::EndsWith("</VTKFile>\n")) << name;
  }
  const Ended again = run({"--out", "out"});
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(names(path() / "out").size(), 10U);
  for (const std::string& name : names(path() / "out")) EXPECT_FALSE(name.ends_with(".part"));
}

TEST_F(Folder, OfARunThatFailsIsEmptyAndTheStatusIsThree) {
  // A folder where a result has to go.
  fs::create_directories(path() / "out/frames.csv.part/mine");
  const Ended ended = run({"--out", "out"});
  EXPECT_EQ(ended.status, 3);
  EXPECT_EQ(ended.out, "");
  EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
  EXPECT_THAT(names(path() / "out"), ElementsAre("frames.csv.part"));
}

TEST(EarlierResults, AreKeptWhereTheScenarioContradictsItself) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", kSmallScene);
  ASSERT_EQ(hvp(place.path(), {"run", "s.toml", "--out", "a"}).status, 0);
  const auto before = names(place.path() / "a");
  const std::vector<std::vector<std::string>> contradictions = {
      {"host.solver=cg", "output.waveform.frames=1", "fidelity.accelerator=cycle-accurate"},
      {"solver.method=chronopoulos-gear", "fidelity.accelerator=cycle-accurate"},
      {"host.solver=cholesky", "accelerator.several.devices=2"},
      {"accelerator.pipeline_clocks=9", "fidelity.accelerator=approximately-timed"},
      {"accelerator.clock=500 MHz"}};
  for (const auto& keys : contradictions) {
    std::vector<std::string> arguments = {"run", "s.toml", "--out", "a"};
    for (const std::string& key : keys) {
      arguments.emplace_back("--set");
      arguments.push_back(key);
    }
    const Ended ended = hvp(place.path(), arguments);
    EXPECT_EQ(ended.status, 2) << keys[0] << ended.err;
    EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
    EXPECT_EQ(names(place.path() / "a"), before) << keys[0];
  }
}

}  // namespace
}  // namespace hvp::cli::folder_test
