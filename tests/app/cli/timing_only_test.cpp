#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>

#include <gmock/gmock.h>

#include "models/files/csv.h"
#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// fidelity.numbers = "none": the times of a run without its numbers.
namespace hvp::cli::timing_only_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

std::vector<std::string> without_reference(const std::string& command,
                                           std::vector<std::string> more = {}) {
  std::vector<std::string> all = {command, "s.toml", "--set", "reference=false"};
  if (command == "run") all.insert(all.end(), {"--out", "out"});
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

class TimingOnlyRun : public ::testing::Test {
 protected:
  TimingOnlyRun() { write(place_.path() / "s.toml", kSmallScene); }
  Ended go(const std::vector<std::string>& arguments) { return hvp(place_.path(), arguments); }
  std::filesystem::path out() const { return place_.path() / "out"; }

 private:
  ScratchDirectory place_;
};

TEST_F(TimingOnlyRun, HasTheTimesAndNoNumberThatLooksLikeAResult) {
  ASSERT_EQ(go(without_reference("run")).status, 0);
  const std::vector<std::string> computed = lines(read(out() / "frames.csv"));
  const Ended ended = go(without_reference("run", {"--set", "fidelity.numbers=none"}));
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("PASS, timing only: worst"));
  EXPECT_THAT(ended.out, HasSubstr("every solve makes all 20 iterations"));
  EXPECT_THAT(ended.out, Not(HasSubstr("0 saturations")));

  // The probe presses from its first tick, and keeps its first node.
  const std::vector<std::string> counted = lines(read(out() / "frames.csv"));
  ASSERT_EQ(counted.size(), computed.size());
  EXPECT_EQ(counted.front(), computed.front());
  const std::set<std::string_view> times = {"frame",   "born_us",      "latency_us", "load_us",
                                            "in_time", "contact_node", "x_m",        "y_m",
                                            "z_m",     "deadline_us"};
  const std::set<std::string_view> numbers = {"force_N", "fx_N", "fy_N", "fz_N", "saturations"};
  const auto header = files::csv_cells(counted.front());
  for (std::size_t line = 1; line < counted.size(); ++line) {
    const auto with = files::csv_cells(computed[line]);
    const auto without = files::csv_cells(counted[line]);
    ASSERT_EQ(without.size(), header.size());
    for (std::size_t i = 0; i < header.size(); ++i) {
      if (times.contains(header[i])) {
        EXPECT_EQ(without[i], with[i]) << header[i];
      }
      if (numbers.contains(header[i])) {
        EXPECT_EQ(without[i], "") << header[i];
      }
    }
  }

  const json summary = json::parse(read(out() / "summary.json"));
  EXPECT_EQ(summary.at("fidelity").at("numbers"), "none");
  for (const char* count : {"saturations", "wraps", "breakdowns", "clamped_words"}) {
    EXPECT_TRUE(summary.at("stability").at(count).is_null()) << count;
  }
  EXPECT_TRUE(summary.at("accuracy").at("displacement_rel").is_null());
  for (const std::string& name : names(out())) EXPECT_THAT(name, Not(StartsWith("deformation")));
}

TEST_F(TimingOnlyRun, RefusesWhatNeedsNumbers) {
  struct Case {
    const char* set;
    const char* rest;
  };
  for (const Case& c :
       {Case{"reference=true", "nobody computes numbers"},
        Case{"refinement.passes=2", "refinement: nobody computes numbers"},
        Case{"host.solver=cg", "expected \"board\", found \"cg\""},
        Case{"fidelity.accelerator=cycle-accurate", "expected approximately-timed"}}) {
    const Ended ended =
        go(without_reference("run", {"--set", "fidelity.numbers=none", "--set", c.set}));
    EXPECT_EQ(ended.status, 2) << c.set;
    EXPECT_THAT(ended.err, HasSubstr(c.rest)) << c.set;
    EXPECT_EQ(lines(ended.err).size(), 1U) << c.set;
  }
}

TEST_F(TimingOnlyRun, IsExplained) {
  const Ended ended = go(without_reference("explain", {"--set", "fidelity.numbers=none"}));
  EXPECT_EQ(ended.status, 0);
  EXPECT_THAT(ended.out, HasSubstr("numbers      none           timing only: all 20 iterations"));
}

}  // namespace
}  // namespace hvp::cli::timing_only_test
