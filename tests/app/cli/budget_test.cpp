#include <nlohmann/json.hpp>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// The verdicts: what the exit status, the terminal and the summary say of a budget.
namespace hvp::cli::budget_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

struct Judged {
  Ended ended;
  json summary;
};

Judged judged(const std::vector<std::string>& sets) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", kSmallScene);
  std::vector<std::string> arguments = {"run", "s.toml", "--out", "out"};
  for (const std::string& set : sets) {
    arguments.push_back("--set");
    arguments.push_back(set);
  }
  Judged j;
  j.ended = hvp(place.path(), arguments);
  j.summary = json::parse(read(place.path() / "out/summary.json"));
  return j;
}

TEST(Budget, ThatHoldsIsStatusZero) {
  const Judged j = judged({});
  EXPECT_EQ(j.ended.status, 0);
  EXPECT_TRUE(j.summary["deadline"]["held"]);
  EXPECT_TRUE(j.summary["load"]["held"]);
}

TEST(Budget, OfALateForceIsStatusOne) {
  // A frame takes 92 µs, 10 of them after the host's work: late, and yet no more work than fits.
  const Judged j = judged({"budget.period=85 us"});
  EXPECT_EQ(j.ended.status, 1);
  EXPECT_EQ(j.ended.err, "");
  EXPECT_THAT(j.ended.out, HasSubstr("force in time  MISSED"));
  EXPECT_FALSE(j.summary["deadline"]["held"]);
  EXPECT_TRUE(j.summary["load"]["held"]);
  EXPECT_EQ(j.summary["deadline"]["misses"], 40);
}

// To the picosecond, and nothing else of the run: the loop does not wait for it.
TEST(Budget, OfAForceThatIsHeldBackIsLessByThat) {
  const Judged now = judged({});
  const Judged later = judged({"host.delay.time=0.5 ms"});
  EXPECT_EQ(later.ended.status, 0);
  const auto latency = [](const Judged& j) {
    return j.summary["deadline"]["worst_us"].get<double>();
  };
  EXPECT_DOUBLE_EQ(latency(later), latency(now) + 500);
  EXPECT_EQ(later.summary["load"], now.summary["load"]);
  EXPECT_EQ(later.summary["accuracy"], now.summary["accuracy"]);
  EXPECT_THAT(later.ended.out, HasSubstr("host delay               500.0 us"));
  // Three periods late, and yet no tick is skipped.
  const Judged late = judged({"host.delay.time=6 ms"});
  EXPECT_EQ(late.ended.status, 1);
  EXPECT_EQ(late.summary["deadline"]["misses"], 40);
  EXPECT_EQ(late.summary["deadline"]["skipped_ticks"], 0);
}

TEST(Budget, OfSkippedTicksIsStatusOne) {
  const Judged j = judged({"budget.period=20 us"});
  EXPECT_EQ(j.ended.status, 1);
  EXPECT_THAT(j.ended.out, HasSubstr("load           EXCEEDED"));
  const json& d = j.summary["deadline"];
  EXPECT_GT(d["skipped_ticks"], 0);
  EXPECT_EQ(d["frames"].get<int>() + d["skipped_ticks"].get<int>(), 40);
  EXPECT_EQ(d["misses"], 40);
}

TEST(Budget, OfASlowBusIsStatusOne) {
  const Judged j = judged({"budget.period=100 us", "bus.read_latency=20 us"});
  EXPECT_EQ(j.ended.status, 1);
}

// The last force that was held is not this frame's force, whenever it was written.
TEST(Budget, OfFramesWithoutASolutionIsStatusOne) {
  const Judged j = judged({"host.timeout=10 us"});
  EXPECT_EQ(j.ended.status, 1);
  EXPECT_THAT(j.ended.out, HasSubstr("40 without a solution"));
  EXPECT_THAT(j.ended.out, Not(HasSubstr("PASS")));
  EXPECT_EQ(j.summary["stability"]["driver_errors"], 40);
  EXPECT_THAT(j.summary["stability"]["flags"].dump(), HasSubstr("solver-timeout"));
  EXPECT_FALSE(j.summary["deadline"]["held"]);
}

}  // namespace
}  // namespace hvp::cli::budget_test
