#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// `hvp device`: the accelerator of a scenario.
namespace hvp::cli::device_test {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Device : public testing::Test {
 protected:
  void SetUp() override { write(place_.path() / "s.toml", kSmallScene); }

  Ended device(std::vector<std::string> further) const {
    further.insert(further.begin(), {"device", "s.toml"});
    return hvp(place_.path(), further);
  }
  json figures(std::vector<std::string> further, int status = 0) const {
    further.emplace_back("--json");
    const Ended ended = device(further);
    EXPECT_EQ(ended.status, status) << ended.err;
    return json::parse(ended.out);
  }

  const ScratchDirectory place_;
};

int used(const json& j, const std::string& type) {
  for (const json& r : j["resources"]) {
    if (r["type"] == type) return r["used"];
  }
  return -1;
}

TEST_F(Device, ShowsWhatAnArchitectAsksForAndWritesNothing) {
  const Ended ended = device({});
  EXPECT_EQ(ended.status, 0) << ended.err;
  for (const char* word :
       {"Clocks of a solve", "Critical path", "inner product", "M4K", "multipliers", "GOPS",
        "largest", "Hz", "If one number changes", "accelerator.partitions 5 -> 6"}) {
    EXPECT_THAT(ended.out, HasSubstr(word));
  }
  EXPECT_THAT(names(place_.path()), ElementsAre("s.toml"));
}

// The fastest clock is the one that the critical path allows, and any above it is refused.
TEST_F(Device, TakesTheFastestClock) {
  const std::string fastest = "accelerator.clock=fastest";
  const json j = figures({"--set", fastest});
  const double highest = j["clock"]["highest_hz"];
  EXPECT_LE(j["clock"]["hz"].get<double>(), highest);
  EXPECT_GT(j["clock"]["hz"].get<double>(), highest - 1e4);
  // Of another architecture another one.
  const json staged =
      figures({"--set", fastest, "--set", "accelerator.absolute_value_register=true"});
  EXPECT_GT(staged["clock"]["hz"].get<double>(), j["clock"]["hz"].get<double>());

  const Ended run = hvp(place_.path(), {"run", "s.toml", "--set", fastest, "--set", "frames=2",
                                        "--set", "output.pictures=false", "--out", "out"});
  EXPECT_EQ(run.status, 0) << run.err;
  const std::string resolved = read(place_.path() / "out/scenario.resolved.toml");
  const std::string hertz = std::to_string(std::llround(j["clock"]["hz"].get<double>()) / 10'000);
  EXPECT_THAT(resolved, HasSubstr("clock = \"" + hertz.substr(0, hertz.size() - 2) + "." +
                                  hertz.substr(hertz.size() - 2)));
  EXPECT_THAT(device({"--set", "accelerator.clock=quick"}).err,
              HasSubstr("accelerator.clock=quick: expected \"fastest\" or a frequency such as "));
}

TEST_F(Device, HasNoFastestClockWithoutDelays) {
  std::string text = read(scenario("").parent_path().parent_path() / "devices/EP2S60.toml");
  text.erase(text.find("[timing]"));
  write(place_.path() / "own.toml", text);
  const Ended ended =
      device({"--set", "accelerator.device=own.toml", "--set", "accelerator.clock=fastest"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, HasSubstr("has no [timing], so that its fastest is not known"));
}

TEST_F(Device, SaysTheSameInJson) {
  const json j = figures({});
  EXPECT_EQ(j["device"]["name"], "EP2S60");
  EXPECT_TRUE(j["fits"]);
  const json& c = j["cycles"];
  EXPECT_EQ(c["iteration"], c["sparse_product"].get<int>() + c["update"].get<int>() +
                                c["direction"].get<int>() + c["divisions"].get<int>());
  EXPECT_EQ(c["solve"],
            c["setup"].get<int>() + c["iterations"].get<int>() * c["iteration"].get<int>());
  EXPECT_DOUBLE_EQ(j["operations_per_s"]["thesis"], 18e9);
  EXPECT_LT(j["operations_per_s"]["product"], j["operations_per_s"]["peak"]);
}

TEST_F(Device, SortsThePathsByTheirLength) {
  const json clock = figures({})["clock"];
  ASSERT_GE(clock["paths"].size(), 2U);
  const double longest = clock["paths"][0]["period_ns"];
  EXPECT_NEAR(1e9 / longest, clock["highest_hz"].get<double>(), 1e-3);
  for (std::size_t i = 1; i < clock["paths"].size(); ++i) {
    EXPECT_LE(clock["paths"][i]["period_ns"], clock["paths"][i - 1]["period_ns"]);
  }
}

// What a line says is what the scenario with that key gives.
TEST_F(Device, WhatIfIsWhatTheChangedScenarioSays) {
  const json j = figures({});
  int tried = 0;
  for (const json& change : j["what_if"]) {
    const std::string key = change["key"];
    if (key != "accelerator.partitions" && key != "accelerator.nodes_per_clock" &&
        key != "solver.method") {
      continue;
    }
    const bool held = change["fits"].get<bool>() &&
                      change["highest_hz"].get<double>() >= j["clock"]["hz"].get<double>();
    const json changed =
        figures({"--set", key + "=" + change["to"].get<std::string>()}, held ? 0 : 1);
    EXPECT_EQ(changed["cycles"]["solve"], change["solve_cycles"]) << key << change["to"];
    EXPECT_EQ(changed["clock"]["highest_hz"], change["highest_hz"]) << key << change["to"];
    EXPECT_EQ(changed["fits"], change["fits"]) << key << change["to"];
    ++tried;
  }
  EXPECT_GE(tried, 8);
}

TEST_F(Device, LargestMeshIsLargerAndSlower) {
  const json j = figures({});
  const int nodes = j["largest_mesh"]["nodes"];
  EXPECT_GT(nodes, j["mesh"]["nodes"].get<int>());
  EXPECT_GT(j["mesh"]["solve_rate_hz"], j["largest_mesh"]["solve_rate_hz"]);
  EXPECT_GT(j["mesh"]["solve_rate_hz"], j["mesh"]["frame_rate_hz"]);
}

TEST_F(Device, ShowsADesignThatDoesNotFitAndEndsWithOne) {
  const json j = figures({"--set", "accelerator.partitions=12"}, 1);
  EXPECT_FALSE(j["fits"]);
  EXPECT_GT(used(j, "multipliers"), 144);
  const Ended ended = device({"--set", "accelerator.partitions=12"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.out, HasSubstr("DOES NOT FIT"));
  // A run of it is refused.
  EXPECT_EQ(hvp(place_.path(), {"run", "s.toml", "--set", "accelerator.partitions=12"}).status, 2);
}

TEST_F(Device, ShowsAClockThatIsNotReachedAndEndsWithOne) {
  const json j = figures({"--set", "accelerator.clock=150 MHz"}, 1);
  EXPECT_FALSE(j["clock"]["reached"]);
  EXPECT_THAT(device({"--set", "accelerator.clock=150 MHz"}).out, HasSubstr("TOO FAST"));
}

// Times are those of the highest clock where the scenario's is not reached.
TEST_F(Device, GivesTimesAtAClockThatIsReached) {
  const json j = figures({"--set", "accelerator.clock=150 MHz"}, 1);
  const double seconds =
      j["cycles"]["solve"].get<double>() / j["clock"]["highest_hz"].get<double>();
  EXPECT_NEAR(j["mesh"]["solve_us"].get<double>(), seconds * 1e6, 1e-3 * seconds * 1e6);
}

// A block that cannot serve a structure at all shows in no count of blocks.
TEST_F(Device, SaysWhatAMemoryCannotDo) {
  const Ended ended = device({"--set", "accelerator.copies_memory=M512"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.out, HasSubstr("DOES NOT FIT: the M512 has no two ports"));
  const json j = figures({"--set", "accelerator.copies_memory=M512"}, 1);
  EXPECT_EQ(j["obstacles"][0]["key"], "accelerator.copies_memory");
}

TEST_F(Device, CountsSeveralDevices) {
  const json one = figures({});
  const json two = figures({"--set", "accelerator.several.devices=2"});
  EXPECT_EQ(two["devices"], 2);
  EXPECT_DOUBLE_EQ(two["operations_per_s"]["thesis"].get<double>(),
                   2 * one["operations_per_s"]["thesis"].get<double>());
  EXPECT_LT(two["operations_per_s"]["product"], two["operations_per_s"]["peak"]);
  EXPECT_GT(two["links"]["clocks_a_solve"], 0);
  EXPECT_FALSE(one.contains("links"));
  // Symmetric storage is of one device alone.
  for (const json& change : two["what_if"]) EXPECT_NE(change["key"], "accelerator.matrix_storage");
}

TEST_F(Device, RefusesAWrongScenarioAsEveryCommandDoes) {
  const Ended ended = device({"--set", "accelerator.partition=5"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, HasSubstr("did you mean \"partitions\""));
  EXPECT_EQ(lines(ended.err).size(), 1U);
}

}  // namespace
}  // namespace hvp::cli::device_test
