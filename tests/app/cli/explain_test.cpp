#include <algorithm>
#include <csignal>
#include <nlohmann/json.hpp>
#include <set>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

namespace hvp::cli::explain_test {
namespace {

using nlohmann::json;
using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class ExplainJson : public ::testing::Test {
 protected:
  ExplainJson() { write(place_.path() / "s.toml", kSmallScene); }

  json with(const std::vector<std::string>& settings, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"explain", "s.toml", "--json"};
    for (const std::string& setting : settings) {
      arguments.insert(arguments.end(), {"--set", setting});
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Ended ended = hvp(place_.path(), arguments);
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_THAT(names(place_.path()), ElementsAre("s.toml"));
    return json::parse(ended.out);
  }
  static std::vector<std::string> modules(const json& told) {
    std::vector<std::string> names;
    for (const json& module : told.at("platform").at("modules")) names.push_back(module.at("name"));
    return names;
  }

  ScratchDirectory place_;
};

TEST_F(ExplainJson, NamesTheModulesThatAreBuiltAndNoOthers) {
  const json told = with({});
  EXPECT_THAT(modules(told),
              ElementsAre("bus", "accelerator", "daq", "access", "servo", "collision"));
  EXPECT_EQ(told.at("platform").at("processes"), 3);
  const json& servo = told.at("platform").at("modules").at(4);
  EXPECT_EQ(servo.at("kind"), "ServoProcess");
  EXPECT_EQ(servo.at("processes"), json::array({{{"name", "servo.run"}, {"kind", "thread"}}}));
}

TEST_F(ExplainJson, AnEffectBringsItsModuleAndProcess) {
  const json told = with({"fidelity.bus=approximately-timed", "bus.traffic=true"});
  EXPECT_THAT(modules(told), Contains("traffic"));
  EXPECT_EQ(told.at("platform").at("processes"), 4);
}

TEST_F(ExplainJson, LooksAtAWaveformWithoutWritingOne) {
  EXPECT_THAT(modules(with({"fidelity.accelerator=cycle-accurate", "output.waveform=true"})),
              Contains("waveform"));
}

TEST_F(ExplainJson, AWallHasNeitherBoardNorFrameSteps) {
  write(place_.path() / "s.toml",
        "[wall]\n[probe]\nstart = ['0 mm', '0 mm', '1 mm']\n[[probe.motion]]\nphase = 'press'\n"
        "to = ['0 mm', '0 mm', '-1 mm']\nduration = '20 ms'\n");
  const json told = with({});
  EXPECT_THAT(modules(told), ElementsAre("bus", "daq", "access", "servo"));
  EXPECT_TRUE(told.at("frame").is_null());
  EXPECT_TRUE(told.at("accelerator").is_null());
  EXPECT_TRUE(told.at("mesh").is_null());
}

TEST_F(ExplainJson, AFrameIsTheSumOfItsSteps) {
  const json frame = with({"dynamics=true", "refinement=true"}).at("frame");
  std::int64_t all = 0;
  std::int64_t awaited = 0;
  for (const json& step : frame.at("steps")) {
    const std::int64_t ps = step.at("ps").get<std::int64_t>() * step.at("times").get<int>();
    all += ps;
    if (!step.at("after_force").get<bool>()) awaited += ps;
  }
  EXPECT_LT(awaited, all);
  EXPECT_DOUBLE_EQ(frame.at("frame_us").get<double>(), static_cast<double>(all) / 1e6);
  EXPECT_DOUBLE_EQ(frame.at("latency_us").get<double>(), static_cast<double>(awaited) / 1e6);
}

// The update of a moving body by its scheme, and none after explicit steps, which make theirs
// before.
TEST_F(ExplainJson, NamesTheUpdateByItsScheme) {
  const auto last = [](const json& told) {
    return told.at("frame").at("steps").back().at("what").get<std::string>();
  };
  const auto cost = [](const json& told) {
    for (const json& effect : told.at("effects")) {
      if (effect.at("path") == "dynamics") return effect.at("adds").get<std::string>();
    }
    return std::string();
  };
  EXPECT_EQ(last(with({"dynamics=true"})), "Newmark's update after the force");
  const json generalised = with({"dynamics=true", "dynamics.scheme=generalised-alpha"});
  EXPECT_EQ(last(generalised), "generalised-α's update after the force");
  EXPECT_THAT(cost(generalised), HasSubstr("generalised-α"));
  const json steps =
      with({"dynamics=true", "dynamics.rayleigh_stiffness=0 s", "host.solver=explicit"});
  EXPECT_THAT(cost(steps), Not(HasSubstr("Newmark")));
  for (const json& step : steps.at("frame").at("steps")) {
    EXPECT_THAT(step.at("what"), Not(HasSubstr("update")));
  }
  EXPECT_THAT(steps.at("frame").at("steps").at(0).at("what"), HasSubstr("(without contact)"));
}

// By the names that a run's summary has, and with its values.
TEST_F(ExplainJson, AgreesWithTheSummaryOfARun) {
  const json told = with({"frames=2"});
  ASSERT_LE(hvp(place_.path(), {"run", "s.toml", "--set", "frames=2", "--out", "out"}).status, 1);
  const json summary = json::parse(read(place_.path() / "out/summary.json"));
  for (const char* key : {"title", "solver", "accelerator", "resources", "mesh", "condition"}) {
    EXPECT_EQ(told.at(key), summary.at(key)) << key;
  }
}

// The thesis' bus does not bring all values within a period of 2 ms.
TEST(ExplainRenewal, SaysWhatTheNextFrameWaits) {
  const ScratchDirectory place;
  std::vector<std::string> arguments = {"explain", scenario("tissue-renewed.toml").string(),
                                        "--set", "budget.period=2 ms"};
  const Ended ended = hvp(place.path(), arguments);
  EXPECT_THAT(ended.out,
              HasSubstr("after the next tick: the next frame begins so late, or is skipped"));
  arguments.emplace_back("--json");
  const json frame = json::parse(hvp(place.path(), arguments).out).at("frame");
  EXPECT_NEAR(frame.at("renewal").at("behind_us").get<double>(),
              frame.at("renewal").at("frame_us").get<double>() - 2000, 1e-6);
}

// What a frame that renews its matrix has on top is what the run then measures: the host's part to
// a tenth, as it depends on the deformation; bus and board to what the accesses around them take.
TEST(ExplainRenewal, IsWhatARunMeasures) {
  const ScratchDirectory place;
  for (const std::string transfer : {"bursts", "programmed-io"}) {
    SCOPED_TRACE(transfer);
    std::vector<std::string> changes = {"frames=160",
                                        "object.model.matrix.renew_every=40",
                                        "solver.method=jacobi-pcg",
                                        "budget.period=8 ms",
                                        "output.pictures=false",
                                        "output.remedies=false",
                                        "reference=false",
                                        "transfer.method=" + transfer,
                                        "output.trace_frames=160"};
    std::vector<std::string> arguments = {scenario("thesis-nonlinear.toml").string()};
    for (const std::string& change : changes) {
      arguments.emplace_back("--set");
      arguments.push_back(change);
    }
    std::vector<std::string> run = {"run", "--out", "out"};
    run.insert(run.end(), arguments.begin(), arguments.end());
    std::vector<std::string> explain = {"explain", "--json"};
    explain.insert(explain.end(), arguments.begin(), arguments.end());
    ASSERT_LE(hvp(place.path(), run).status, 1);
    const json renewal = json::parse(hvp(place.path(), explain).out).at("frame").at("renewal");
    EXPECT_EQ(renewal.at("every"), 40);
    EXPECT_NEAR(renewal.at("behind_us").get<double>(),
                std::max(0.0, renewal.at("frame_us").get<double>() - 8000), 1e-6);
    const json& steps = renewal.at("steps");
    ASSERT_EQ(steps.size(), 4U);
    const auto us = [&](std::size_t step) { return steps.at(step).at("us").get<double>(); };
    const json trace = json::parse(read(place.path() / "out/trace.json")).at("traceEvents");
    // The first of each, and what the bus does between those of host and board.
    const auto first = [&](const char* part, const char* phase) {
      for (const json& event : trace) {
        if (event.value("cat", "") == part && event.at("name") == phase) return event;
      }
      ADD_FAILURE() << part << " " << phase;
      return json({{"ts", 0.0}, {"dur", 0.0}});
    };
    const json assemble = first("host", "assemble");
    const json driver = first("host", "load values");
    const json board = first("fpga", "load values");
    double moved = 0;
    for (const json& event : trace) {
      if (event.value("cat", "") != "bus" || event.at("pid") != 1 || event.at("ph") != "X")
        continue;
      const double start = event.at("ts").get<double>();
      if (start < driver.at("ts") || start >= board.at("ts")) continue;
      moved += event.at("dur").get<double>();
    }
    EXPECT_GT(us(0), 100);
    EXPECT_NEAR(us(0), assemble.at("dur").get<double>(), 0.1 * us(0));
    EXPECT_NEAR(us(1), driver.at("dur").get<double>(), 1e-3 * us(1));
    EXPECT_NEAR(us(2), moved, 0.02 * us(2));
    EXPECT_NEAR(us(3), board.at("dur").get<double>(), 1e-3 * us(3));
  }
}

TEST_F(ExplainJson, TimesEveryEffectOrSaysWhyNot) {
  const json told = with({"frames=10"}, {"--measure"});
  const json& measured = told.at("measured");
  EXPECT_EQ(measured.at("frames"), 10);
  EXPECT_GT(measured.at("wall_s_per_s"), 0);
  ASSERT_EQ(measured.at("effects").size(), told.at("effects").size());
  for (std::size_t i = 0; i < told.at("effects").size(); ++i) {
    const json& effect = measured.at("effects").at(i);
    EXPECT_EQ(effect.at("path"), told.at("effects").at(i).at("path"));
    EXPECT_EQ(effect.at("built"), told.at("effects").at(i).at("built"));
    EXPECT_NE(effect.contains("refused"), effect.contains("difference_s_per_s")) << effect;
    if (effect.at("path") == "reference") {
      EXPECT_EQ(effect.at("setting"), "reference=false");
    }
    if (effect.at("path") == "dynamics") {
      EXPECT_GT(effect.at("wall_s_per_s"), 0);
    }
    // What it needs beside it is brought: all is timed but what contradicts the scenario, and a
    // list, which has no item of its own.
    if (effect.contains("refused")) {
      EXPECT_THAT(effect.at("path").get<std::string>(), AnyOf("wall", "fault")) << effect;
    }
    if (effect.at("path") == "device.friction") {
      EXPECT_EQ(effect.at("along"), json({"device.dynamics=true"}));
    }
    if (effect.at("path") == "device.dac") {
      EXPECT_EQ(effect.at("along"), json({"device.motor=true", "device.amplifier=true"}));
    }
    // There by another key, which is then what is laid over.
    if (effect.at("path") == "transfer.dma") {
      EXPECT_EQ(effect.at("setting"), R"(transfer.method="dma")");
    }
  }
}

TEST_F(ExplainJson, AFaultIsTakenOutWithItsList) {
  const json told = with({"frames=10", "fault[0]={kind='lost-interrupt', frame=1}"}, {"--measure"});
  for (const json& effect : told.at("measured").at("effects")) {
    if (effect.at("path") != "fault") continue;
    EXPECT_EQ(effect.at("setting"), "fault=[]");
    EXPECT_FALSE(effect.contains("refused")) << effect;
  }
}

// Between two runs, or in the middle of one: the first process only looks at the platform.
TEST_F(ExplainJson, EndsAsTheSignalWouldWhileItMeasures) {
  Program program(place_.path(), {"explain", "s.toml", "--json", "--measure"});
  std::set<pid_t> seen;
  while (seen.size() < 4 && !program.ended()) {
    for (const pid_t child : program.children()) seen.insert(child);
  }
  program.signal(SIGTERM);
  const Ended ended = program.wait();
  EXPECT_EQ(ended.signal, SIGTERM);
  EXPECT_EQ(ended.out, "");
}

TEST(Explain, HasASectionOfThePlatform) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", kSmallScene);
  const Ended ended = hvp(place.path(), {"explain", "s.toml"});
  EXPECT_THAT(ended.out, HasSubstr("\nThe platform: 6 modules, 3 processes\n"));
  EXPECT_THAT(ended.out, ::testing::ContainsRegex("collision +CollisionProcess +thread run\n"));
  EXPECT_THAT(ended.out, Not(HasSubstr("Wall-clock time")));
}

}  // namespace
}  // namespace hvp::cli::explain_test
