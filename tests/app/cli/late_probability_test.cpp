// The probability of a late force against frames that were counted, and against a closed form.
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "models/files/csv.h"
#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

namespace hvp::cli::late_probability_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

class LateProbability : public ::testing::Test {
 protected:
  // A run of jittery-host.toml for its times alone.
  Ended run(int frames, const std::vector<std::string>& settings) {
    std::vector<std::string> arguments = {"run", scenario("jittery-host.toml").string(), "--out",
                                          (place_.path() / "out").string()};
    for (const char* const setting :
         {"reference=false", "fidelity.numbers=none", "output.pictures=false"}) {
      arguments.insert(arguments.end(), {"--set", setting});
    }
    arguments.insert(arguments.end(), {"--set", "frames=" + std::to_string(frames)});
    for (const std::string& setting : settings) {
      arguments.insert(arguments.end(), {"--set", setting});
    }
    return hvp(place_.path(), arguments);
  }
  json deadline() const {
    return json::parse(read(place_.path() / "out/summary.json")).at("deadline");
  }
  std::vector<double> latencies_us() const {
    const std::vector<std::string> rows = lines(read(place_.path() / "out/frames.csv"));
    std::vector<double> found;
    for (std::size_t row = 1; row < rows.size(); ++row) {
      found.push_back(std::stod(std::string(files::csv_cells(rows[row])[2])));
    }
    return found;
  }

  ScratchDirectory place_;
};

TEST_F(LateProbability, IsTheShareOfFramesThatAreLate) {
  write(place_.path() / "log.csv", "latency_us,count\n5,600\n20,300\n40,100\n");
  const std::string log = "host.wake_up.samples=" + (place_.path() / "log.csv").string();
  const std::vector<std::vector<std::string>> cases = {
      {},
      {"host.wake_up=false", "host.jitter.maximum=400 us"},
      {"host.jitter=false"},
      {"host.cores=1"},
      {"host.wake_up=false", "host.jitter=false", "host.interrupt_latencies.mean=80 us",
       "host.interrupt_latencies.maximum=1 ms"},
      {"host.wake_up={}", "host.wake_up.distribution=measured", log, "host.wake_up.tail=pareto",
       "host.wake_up.tail_from=40 us", "host.wake_up.tail_scale=80 us",
       "host.wake_up.tail_shape=0.2"},
  };
  for (const auto& settings : cases) {
    constexpr int kFrames = 20'000;
    const Ended ended = run(kFrames, settings);
    ASSERT_LE(ended.status, 1) << ended.err;
    const json found = deadline();
    const json& late = found.at("late_probability");
    const std::string what = ::testing::PrintToString(settings);
    ASSERT_TRUE(late.at("independent")) << what;
    const double share = late.at("share");
    EXPECT_LE(late.at("low"), share);
    EXPECT_GE(late.at("high"), share);
    EXPECT_GT(share, 5e-3) << what;
    EXPECT_LT(share, 0.5) << what;
    EXPECT_GE(late.at("frames").get<int>() + late.at("left_out").get<int>(), kFrames - 5) << what;
    const double counted = found.at("misses").get<double>() / kFrames;
    // A late frame often makes the next one late, so that the counts scatter twice as much as
    // independent ones at most.
    const double error = 2 * std::sqrt(share * (1 - share) / kFrames);
    EXPECT_NEAR(counted, share, 3 * error) << what;
  }
}

// A chain of two exponential times at less than a millionth: in three digits.
TEST_F(LateProbability, IsExactWhereNoFrameIsLate) {
  const double a = 15;
  const double b = 12;
  ASSERT_EQ(run(200, {"host.wake_up=false", "host.jitter=false"}).status, 0);
  const double budget = deadline().at("budget_us");
  double exact = 0;
  const std::vector<double> without = latencies_us();
  for (const double latency : without) {
    constexpr double kInterrupt = 5;  // host.interrupt_latency, in whose place a time is drawn
    const double left = budget - (latency - kInterrupt);
    exact += (a * std::exp(-left / a) - b * std::exp(-left / b)) / (a - b);
  }
  exact /= static_cast<double>(without.size());
  const Ended ended =
      run(200, {"host.wake_up=false", "host.jitter={}", "host.jitter.mean=15 us",
                "host.jitter.maximum=1 ms", "host.interrupt_latencies.mean=12 us",
                "host.interrupt_latencies.minimum=0 s", "host.interrupt_latencies.maximum=1 ms"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const json late = deadline().at("late_probability");
  EXPECT_LT(exact, 2e-6);
  EXPECT_GT(exact, 1e-8);
  EXPECT_NEAR(late.at("share").get<double>() / exact, 1, 5e-3) << exact;
  EXPECT_LE(late.at("low"), exact);
  EXPECT_GE(late.at("high"), exact);
  EXPECT_THAT(ended.out, HasSubstr("late by chance with a probability of "));
}

// Ten times as many samples tell the tail better: the logarithm's interval is √10 narrower. A tail
// that is not Pareto's has none.
TEST_F(LateProbability, HasAnIntervalByWhatTheSamplesTellOfTheTail) {
  std::vector<double> width;
  for (const int count : {1000, 10'000}) {
    write(place_.path() / "log.csv", "latency_us,count\n5,600000\n20,300000\n30," +
                                         std::to_string(count / 2) + "\n40," +
                                         std::to_string(count / 2) + "\n");
    const std::vector<std::string> settings = {
        "host.wake_up={}",
        "host.wake_up.distribution=measured",
        "host.wake_up.samples=" + (place_.path() / "log.csv").string(),
        "host.wake_up.tail=pareto",
        "host.wake_up.tail_from=30 us",
        "host.wake_up.tail_scale=15 us",
        "host.wake_up.tail_shape=0.1",
        "host.jitter=false"};
    const Ended ended = run(500, settings);
    ASSERT_LE(ended.status, 1) << ended.err;
    const json late = deadline().at("late_probability");
    const double share = late.at("share");
    const double low = late.at("tail_low");
    const double high = late.at("tail_high");
    EXPECT_LT(low, share);
    EXPECT_GT(high, share);
    EXPECT_THAT(ended.out, HasSubstr("with 95 %, by what the tail's samples tell"));
    width.push_back(std::log(high / low));
  }
  EXPECT_NEAR(width[0] / width[1], std::sqrt(10), 0.4);
  ASSERT_LE(run(500, {}).status, 1);
  EXPECT_TRUE(deadline().at("late_probability").at("tail_low").is_null());
}

TEST_F(LateProbability, IsNotSaidWhereTheRestDependsOnWhatIsDrawn) {
  // The force of a pipelined frame waits for the next tick, however late its own was.
  const Ended ended =
      run(3000, {"host.pipeline_depth=1", "budget.period=850 us", "host.wake_up=false"});
  EXPECT_THAT(ended.out, HasSubstr("late by chance not known: the rest of a frame depends on"));
  const json late = deadline().at("late_probability");
  EXPECT_FALSE(late.at("independent"));
  EXPECT_TRUE(late.at("share").is_null());
}

// Few different times, one of them rare and long, and a rest that changes along the run: none of
// that is a dependence.
TEST_F(LateProbability, IsSaidWhateverTheDistributionLooksLike) {
  write(place_.path() / "log.csv", "latency_us,count\n3,500\n4,400\n20,90\n90,10\n400,1\n");
  const std::string log = (place_.path() / "log.csv").string();
  for (int seed = 1; seed <= 6; ++seed) {
    ASSERT_LE(
        run(2000, {"host.wake_up=false", "host.jitter={}", "host.jitter.distribution=measured",
                   "host.jitter.samples=" + log, "seed=" + std::to_string(seed)})
            .status,
        1);
    EXPECT_TRUE(deadline().at("late_probability").at("independent")) << seed;
    ASSERT_LE(
        run(2000, {"host.jitter=false", "host.wake_up={}", "host.wake_up.distribution=measured",
                   "host.wake_up.samples=" + log, "host.wake_up.tail=pareto",
                   "host.wake_up.tail_from=20 us", "host.wake_up.tail_scale=60 us",
                   "host.wake_up.tail_shape=0.6", "seed=" + std::to_string(seed)})
            .status,
        1);
    EXPECT_TRUE(deadline().at("late_probability").at("independent")) << seed;
  }
}

TEST_F(LateProbability, IsNotThereWithoutDrawnTimes) {
  const Ended ended =
      run(100, {"host.wake_up={}", "host.wake_up.distribution=constant", "host.jitter=false"});
  EXPECT_THAT(ended.out, Not(HasSubstr("by chance")));
  EXPECT_TRUE(deadline().at("late_probability").is_null());
}

TEST_F(LateProbability, NeedsEnoughFrames) {
  const Ended ended = run(40, {});
  EXPECT_THAT(ended.out, HasSubstr("late by chance not known: too few frames are alike"));
  EXPECT_FALSE(deadline().at("late_probability").at("independent"));
  EXPECT_TRUE(deadline().at("late_probability").at("share").is_null());
}

}  // namespace
}  // namespace hvp::cli::late_probability_test
