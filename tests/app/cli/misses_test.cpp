// The probability of a late force by importance sampling, against frames that were counted and
// against closed forms.
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "models/files/csv.h"
#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

namespace hvp::cli::misses_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class Misses : public ::testing::Test {
 protected:
  Ended misses(const std::vector<std::string>& settings, bool as_json = true) {
    std::vector<std::string> arguments = {"misses", scenario("jittery-host.toml").string(),
                                          "--runs", "150"};
    if (as_json) arguments.emplace_back("--json");
    add(settings, arguments);
    return hvp(place_.path(), arguments);
  }
  // What a run counts, of its times alone.
  json counted(int frames, const std::vector<std::string>& settings) {
    std::vector<std::string> arguments = {"run",   scenario("jittery-host.toml").string(),
                                          "--out", (place_.path() / "out").string(),
                                          "--set", "frames=" + std::to_string(frames)};
    add({"reference=false", "fidelity.numbers=none", "output.pictures=false",
         "output.trace_frames=0"},
        arguments);
    add(settings, arguments);
    EXPECT_LE(hvp(place_.path(), arguments).status, 1);
    return json::parse(read(place_.path() / "out/summary.json")).at("deadline");
  }
  static void add(const std::vector<std::string>& settings, std::vector<std::string>& arguments) {
    for (const std::string& setting : settings) {
      arguments.insert(arguments.end(), {"--set", setting});
    }
  }

  ScratchDirectory place_;
};

// A chain of two exponential times at less than a millionth.
TEST_F(Misses, AreThoseOfTheClosedForm) {
  const double a = 15;
  const double b = 12;
  const json plain = counted(200, {"host.wake_up=false", "host.jitter=false"});
  const double budget = plain.at("budget_us");
  double exact = 0;
  const std::vector<std::string> rows = lines(read(place_.path() / "out/frames.csv"));
  for (std::size_t row = 1; row < rows.size(); ++row) {
    const double latency = std::stod(std::string(files::csv_cells(rows[row])[2]));
    constexpr double kInterrupt = 5;  // host.interrupt_latency, in whose place a time is drawn
    const double left = budget - (latency - kInterrupt);
    exact += (a * std::exp(-left / a) - b * std::exp(-left / b)) / (a - b) /
             static_cast<double>(rows.size() - 1);
  }
  const Ended ended =
      misses({"frames=200", "host.wake_up=false", "host.jitter={}", "host.jitter.mean=15 us",
              "host.jitter.maximum=1 ms", "host.interrupt_latencies.mean=12 us",
              "host.interrupt_latencies.minimum=0 s", "host.interrupt_latencies.maximum=1 ms"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const json found = json::parse(ended.out);
  EXPECT_LT(exact, 2e-6);
  ASSERT_TRUE(found.at("low").is_number()) << ended.out;
  EXPECT_LT(found.at("low"), exact);
  EXPECT_GT(found.at("high"), exact);
  EXPECT_NEAR(found.at("share").get<double>() / exact, 1, 0.5);
}

// A pipeline's force waits for a tick that is late itself: no convolution knows that.
TEST_F(Misses, OfAPipelineAreThoseOfFramesThatWereCounted) {
  const std::vector<std::string> pipeline = {"host.pipeline_depth=1", "budget.period=850us",
                                             "host.wake_up.spread=3"};
  const json found = json::parse(misses(pipeline).out);
  EXPECT_TRUE(found.at("by_convolution").is_null());
  constexpr int kFrames = 300'000;
  std::vector<std::string> other_seed = pipeline;
  other_seed.emplace_back("seed=77");
  const double plain = counted(kFrames, other_seed).at("misses").get<double>() / kFrames;
  // A late one often makes the next one late: twice the error of independent ones at most.
  const double error = 2 * std::sqrt(plain / kFrames);
  EXPECT_GT(plain, 1e-4);
  EXPECT_LT(found.at("low").get<double>(), plain + 2 * error);
  EXPECT_GT(found.at("high").get<double>(), plain - 2 * error);
}

TEST_F(Misses, AreTheSameAgain) {
  const std::vector<std::string> settings = {"host.wake_up.spread=2", "frames=300"};
  const Ended once = misses(settings, false);
  EXPECT_EQ(once.status, 0) << once.err;
  EXPECT_THAT(once.out, HasSubstr("  drawn           host.wake_up, up to 2 times a frame\n"));
  EXPECT_EQ(once.out, misses(settings, false).out);
}

// Where all are late there is no end of a row of late frames, and nothing is rare.
TEST_F(Misses, ThatAreTheNormAreCountedAsTheyCome) {
  const Ended ended = misses({"budget.period=700us", "frames=200"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const json found = json::parse(ended.out);
  EXPECT_TRUE(found.at("plain"));
  EXPECT_EQ(found.at("share"), 1);
}

// The increments of refinement need numbers.
TEST_F(Misses, OfAScenarioThatNeedsNumbersAreOfARunWithThem) {
  const Ended ended =
      hvp(place_.path(), {"misses", scenario("thesis-refined.toml").string(), "--set",
                          "host.wake_up.mean=5us", "--set", "frames=60", "--runs", "2"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("drawn           host.wake_up"));
}

TEST_F(Misses, NeedATimeThatIsDrawn) {
  const Ended ended = misses({"host.jitter=false", "host.wake_up=false"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, HasSubstr("no time is drawn in this scenario: expected [host.jitter]"));
}

TEST_F(Misses, SayWhereNoneWasSeen) {
  const Ended ended = misses(
      {"host.wake_up=false", "host.interrupt_latencies=false", "frames=100", "seed=3"}, false);
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("none of 10000 frames was late"));
}

}  // namespace
}  // namespace hvp::cli::misses_test
