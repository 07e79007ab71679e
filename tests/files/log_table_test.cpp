#include "models/files/log_table.h"

#include <cmath>
#include <cstdint>
#include <fstream>
#include <numbers>
#include <sstream>
#include <streambuf>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "models/config/input_error.h"

namespace hvp::files::log_table_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Log log_of(const std::string& text, const LogOptions& options = {}) {
  std::istringstream in(text);
  return read_log(in, "log.csv", options);
}

std::string refusal(const std::string& text, const LogOptions& options = {}) {
  try {
    log_of(text, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "taken";
}

// Rows of a log at 10 Hz whose second column is the square of the sample's number: line 2 is
// sample 0. `other` takes the place of sample `at`; empty: the sample is not there.
std::string rows(int count, int at = -1, const std::string& other = "") {
  std::string text;
  for (int i = 0; i < count; ++i) {
    if (i != at) {
      text += fmt::format("{:.1f},{}\n", 0.1 * i, i * i);
    } else if (!other.empty()) {
      text += other + '\n';
    }
  }
  return text;
}

const std::string kHeader = "time_s,force_N\n";

TEST(LogTable, HasColumnsInSiUnits) {
  std::string text = "time_ms,force_mN,angle_deg,note\n";
  for (int i = 0; i < 10; ++i) text += fmt::format("{},{},{},x\n", i, 10 * i, 18 * i);
  const Log log = log_of(text);
  EXPECT_EQ(log.samples, 10U);
  EXPECT_EQ(log.time[3], 0.003);
  EXPECT_EQ(log.column("force", "N").values[7], 0.07);
  EXPECT_DOUBLE_EQ(log.column("angle", "rad").values[5], std::numbers::pi / 2);
  EXPECT_EQ(log.column("angle", "rad").number, 3U);
  EXPECT_THAT(log.left_aside, ElementsAre("note"));
  EXPECT_THAT(log.warnings, IsEmpty());
  EXPECT_TRUE(log.spacing.even);
  EXPECT_DOUBLE_EQ(log.spacing.period, 1e-3);
}

// The header of the records of tissue, whose travel begins at rest.
TEST(LogTable, ReadsAnIndentation) {
  std::string text = "time_s,force_N,travel_mm,gap_mm\n";
  for (int i = 0; i < 100; ++i) {
    const double travel = i < 20 ? 0 : 0.12 * (i - 20);
    text += fmt::format("{:.4f},{:.6f},{:.6f},{:.6f}\n", 0.1 * i, travel * travel, travel,
                        13.124263 - travel);
  }
  const Log log = log_of(text, {.quantities = {"force", "travel"}});
  EXPECT_EQ(log.columns.size(), 2U);
  EXPECT_EQ(log.column("travel", "m").values[21], 0.00012);
  EXPECT_THAT(log.left_aside, ElementsAre("gap_mm"));
  EXPECT_THAT(log.warnings, IsEmpty());
  EXPECT_NEAR(log.spacing.period, 0.1, 1e-15);
}

TEST(LogTable, TakesTheLongestUnit) {
  std::string text = "time_s,velocity_m_s,torque_mN_m\n";
  for (int i = 0; i < 10; ++i) text += fmt::format("{},{},{}\n", i, 2 * i, 3 * i);
  const Log log = log_of(text);
  EXPECT_EQ(log.column("velocity", "m/s").values[1], 2);
  EXPECT_EQ(log.column("torque", "N m").values[1], 0.003);
}

TEST(LogTable, MapsOtherHeaders) {
  const std::string text = "t,Load (mN),x,x\n" + [] {
    std::string r;
    for (int i = 0; i < 10; ++i) r += fmt::format("{},{},{},{}\n", i, 5 * i, 2 * i, 7 * i);
    return r;
  }();
  const Log log = log_of(text, {.columns = {"time_s=t", "force_mN=Load (mN)", "travel_mm=4"}});
  EXPECT_EQ(log.time[2], 2);
  EXPECT_EQ(log.column("force", "N").values[1], 0.005);
  EXPECT_EQ(log.column("travel", "m").values[1], 0.007);
  EXPECT_THAT(log.left_aside, ElementsAre("x"));
  EXPECT_EQ(refusal(text, {.columns = {"time_s=t", "force_N=x"}}),
            "log.csv:1: several columns are called \"x\": name it by its number, from 1");
  EXPECT_EQ(refusal(text, {.columns = {"time_s=t", "force_N=Kraft"}}),
            "log.csv:1: has no column \"Kraft\": expected one of t, Load (mN), x, x, or a number "
            "from 1 to 4");
  EXPECT_EQ(refusal(text, {.columns = {"time_s=t", "force=x"}}),
            "\"force=x\": expected a name with a unit and the header's, such as force_N=Load or "
            "force_N=2");
  EXPECT_EQ(refusal(text, {.columns = {"time_s=1", "time_ms=2"}}),
            "\"time_ms=2\": column 1 gives the time already");
}

TEST(LogTable, PrefersWhatIsMapped) {
  std::string text = "time_s,force_N,force_mN\n";
  for (int i = 0; i < 10; ++i) text += fmt::format("{},{},{}\n", i, i, 2 * i);
  EXPECT_EQ(refusal(text),
            "log.csv:1: columns 2 and 3 both give the force: choose one by --column force_mN=3");
  const Log log = log_of(text, {.columns = {"force_mN=3"}});
  EXPECT_EQ(log.column("force", "N").values[1], 0.002);
  EXPECT_THAT(log.left_aside, ElementsAre("force_N"));
}

TEST(LogTable, TakesCountsOfAKnownResolution) {
  std::string text = "time_s,position_counts\n";
  for (int i = 0; i < 10; ++i) text += fmt::format("{},{}\n", i, 100 * i);
  EXPECT_EQ(refusal(text),
            "log.csv:1: column 2 (position_counts) is in counts: expected their resolution to be "
            "given");
  const Log log = log_of(text, {.count_size = 2e-6, .count_unit = "m"});
  EXPECT_DOUBLE_EQ(log.column("position", "m").values[3], 6e-4);
  EXPECT_THAT(refusal(text, {.count_size = 0.0}), HasSubstr("expected more than 0"));
}

TEST(LogTable, MayBeAList) {
  const Log log = log_of("bytes,latency_us,count\n64,1.5,10\n64,1.4,3\n4096,9,2\n",
                         {.over_time = false, .least_samples = 3});
  EXPECT_THAT(log.column("size", "B").values, ElementsAre(64, 64, 4096));
  EXPECT_EQ(log.column("latency", "s").values[1], 1.4e-6);
  EXPECT_EQ(log.column("count", "").values[2], 2);
  EXPECT_THAT(log.time, IsEmpty());
}

// As a bus' log tells writes from reads.
TEST(LogTable, TakesNumbersOfAnything) {
  const Log log = log_of("bytes,latency_us,write_count\n64,1.5,0\n64,1.4,1\n4096,9,1\n",
                         {.quantities = {"write"}, .over_time = false, .least_samples = 3});
  ASSERT_NE(log.find("write"), nullptr);
  EXPECT_THAT(log.column("write", "").values, ElementsAre(0, 1, 1));
}

TEST(LogTable, MayHaveASampleRateInPlaceOfTheTime) {
  std::string text = "force_N\n";
  for (int i = 0; i < 10; ++i) text += fmt::format("{}\n", i);
  const Log log = log_of(text, {.sample_rate = 1000.0});
  EXPECT_EQ(log.time[9], 0.009);
  EXPECT_EQ(log.spacing.period, 0.001);
  ASSERT_EQ(log.spacing.stretches.size(), 1U);
  EXPECT_EQ(log.spacing.stretches[0].end, 10U);
  EXPECT_EQ(refusal(text),
            "log.csv:1: has no column time_s, time_ms, time_us, time_ns or time_min, and no sample "
            "rate is given: found force_N; name it by --column time_s=NAME");
  // A rate that is given counts for more than a time of another one.
  const Log both = log_of(kHeader + rows(10), {.sample_rate = 1000.0});
  EXPECT_EQ(both.time[9], 0.009);
  EXPECT_THAT(both.warnings.front(), HasSubstr("at the rate that is given"));
  const Log repeated = log_of("time_s,force_N\n0,1\n0,2\n0,3\n1,4\n1,5\n1,6\n2,7\n2,8\n2,9\n3,1\n",
                              {.sample_rate = 3.0});
  EXPECT_DOUBLE_EQ(repeated.time[9], 3.0);
}

TEST(LogTable, SaysWhatItHasNot) {
  const Log log = log_of(kHeader + rows(10));
  const auto wrong = [&](const char* quantity, const char* si) -> std::string {
    try {
      log.column(quantity, si);
    } catch (const InputError& error) {
      return error.what();
    }
    return "found";
  };
  EXPECT_EQ(wrong("current", "A"),
            "log.csv: has no column current_A or current_mA: name it by --column current_A=NAME; "
            "left aside: none");
  EXPECT_EQ(wrong("force", "N m"),
            "log.csv: column 2 (force_N) is in N: expected force_Nm, force_mNm, force_N_m or "
            "force_mN_m");
  EXPECT_EQ(refusal("time_s,a\n" + rows(10)),
            "log.csv:1: has no column of a quantity beside the time, whose name ends in a unit: "
            "found time_s, a");
}

TEST(LogTable, NeedsAHeader) {
  EXPECT_EQ(refusal(""),
            "log.csv:1: expected names of columns with units, such as time_s,force_N; found none");
  EXPECT_EQ(refusal("# only this\n"),
            "log.csv:2: expected names of columns with units, such as time_s,force_N; found none");
  EXPECT_EQ(refusal(rows(10)),
            "log.csv:1: expected names of columns with units, such as time_s,force_N; found 0.0, "
            "0");
}

TEST(LogTable, NeedsSamples) {
  EXPECT_EQ(refusal(kHeader), "log.csv: 0 samples, expected at least 10");
  EXPECT_EQ(refusal(kHeader + rows(9)), "log.csv: 9 samples, expected at least 10");
  EXPECT_EQ(log_of(kHeader + rows(10)).samples, 10U);
}

TEST(LogTable, RefusesTimeThatDoesNotGrow) {
  EXPECT_EQ(refusal(kHeader + rows(12, 5, "0.35,25")),
            "log.csv:7: column 1 (time_s) goes back to 0.35 s from 0.4 s: expected more than in "
            "the row before");
  EXPECT_EQ(refusal(kHeader + rows(12, 5, "0.4,25")),
            "log.csv:7: column 1 (time_s) repeats 0.4 s with other values: expected more than in "
            "the row before");
  EXPECT_EQ(refusal(kHeader + rows(12, 5, "0.4,16\n0.4,16")),
            "log.csv:8: column 1 (time_s) repeats 0.4 s a second time: expected more than in the "
            "row before");
}

TEST(LogTable, LeavesOutARowThatRepeatsTheOneBefore) {
  const Log log = log_of(kHeader + rows(12, 5, "0.4,16\n0.5,25"));
  EXPECT_EQ(log.samples, 12U);
  EXPECT_THAT(log.warnings, ElementsAre("log.csv:7: repeats the row before and is left out"));
}

TEST(LogTable, IsReadInPiecesAroundGaps) {
  const Log log = log_of(kHeader + rows(30, 12));
  ASSERT_EQ(log.spacing.stretches.size(), 2U);
  EXPECT_EQ(log.spacing.stretches[0].end, 12U);
  EXPECT_EQ(log.spacing.stretches[1].begin, 12U);
  EXPECT_EQ(log.spacing.stretches[1].end, 29U);
  EXPECT_TRUE(log.spacing.even);
  EXPECT_THAT(log.warnings, ElementsAre("log.csv:14: a gap of 0.2 s after 1.1 s at a period of 0.1 "
                                        "s, samples missing: 1; read in pieces"));
}

TEST(LogTable, NamesNoMoreThanFiveGaps) {
  std::string text = kHeader;
  for (int i = 0; i < 100; ++i) {
    if (i % 10 != 9) text += fmt::format("{:.1f},{}\n", 0.1 * i, i);
  }
  const Log log = log_of(text);
  EXPECT_EQ(log.spacing.stretches.size(), 10U);
  ASSERT_EQ(log.warnings.size(), 6U);
  EXPECT_EQ(log.warnings[5], "log.csv: has 4 further gaps");
}

TEST(LogTable, SpacesJitterEvenly) {
  std::string text = kHeader;
  for (int i = 0; i < 100; ++i) {
    text += fmt::format("{:.4f},{}\n", 0.1 * i + 0.008 * std::sin(1.0 * i * i), i);
  }
  const Log log = log_of(text);
  EXPECT_TRUE(log.spacing.even);
  EXPECT_NEAR(log.spacing.period, 0.1, 1e-4);
  EXPECT_NEAR(log.spacing.jitter, 0.08, 0.02);
  for (std::size_t i = 1; i < log.time.size(); ++i) {
    ASSERT_NEAR(log.time[i] - log.time[i - 1], log.spacing.period, 1e-13);
  }
  ASSERT_EQ(log.warnings.size(), 1U);
  EXPECT_THAT(log.warnings[0], HasSubstr("rms: taken as even"));
}

// Every twelfth stamp is late by half a period: that is no clock's jitter.
std::string uneven_log() {
  std::string text = kHeader;
  for (int i = 0; i < 120; ++i) {
    text += fmt::format("{},{}\n", 0.1 * i + (i % 12 == 5 ? 0.049 : 0), i);
  }
  return text;
}

TEST(LogTable, LeavesMoreJitterAsItIs) {
  const Log log = log_of(uneven_log());
  EXPECT_FALSE(log.spacing.even);
  EXPECT_NEAR(log.time[53], 5.349, 1e-12);
  ASSERT_EQ(log.warnings.size(), 1U);
  EXPECT_THAT(log.warnings[0],
              HasSubstr("log.csv:115: the time strays up to 45 % of the period of"));
  EXPECT_THAT(log.warnings[0], HasSubstr("rms: taken as it is"));
}

// One stamp that is late by a seventh of a period says nothing against the clock.
TEST(LogTable, TakesASingleStrayForJitter) {
  std::string text = kHeader;
  for (int i = 0; i < 100; ++i) text += fmt::format("{},{}\n", 0.1 * i + (i == 50 ? 0.014 : 0), i);
  const Log log = log_of(text);
  EXPECT_TRUE(log.spacing.even);
  EXPECT_EQ(log.spacing.strays, 50U);
  ASSERT_EQ(log.warnings.size(), 1U);
  EXPECT_THAT(log.warnings[0], HasSubstr("log.csv:52: the time strays up to 13.9 % of the period"));
}

// A clock that runs 0.07 % fast, in whole milliseconds: no sample is missing.
TEST(LogTable, TakesStepsOfTwoUnitsForRounding) {
  std::string text = kHeader;
  for (int i = 0; i < 4000; ++i) {
    text += fmt::format("{:.3f},{}\n", std::floor(i * 1.0007) * 1e-3, i);
  }
  const Log log = log_of(text);
  EXPECT_TRUE(log.spacing.even);
  EXPECT_EQ(log.spacing.stretches.size(), 1U);
  EXPECT_NEAR(log.spacing.period, 1.0007e-3, 1e-6);
  ASSERT_EQ(log.warnings.size(), 1U);
  EXPECT_THAT(log.warnings[0], HasSubstr("taken for the rounding of a clock"));
}

// Stamps that stray too far are no matter where the rate is known.
TEST(LogTable, TakesTheRateThatIsGivenForUnevenStamps) {
  const Log log = log_of(uneven_log(), {.sample_rate = 10});
  EXPECT_TRUE(log.spacing.even);
  EXPECT_DOUBLE_EQ(log.time[53], 5.3);
  ASSERT_EQ(log.warnings.size(), 1U);
  EXPECT_THAT(log.warnings[0], HasSubstr("at the rate that is given"));
}

TEST(LogTable, MayHaveHadNoPeriod) {
  std::string text = kHeader;
  for (int i = 0; i < 20; ++i) text += fmt::format("{},{}\n", std::pow(1.5, i), i);
  const Log log = log_of(text);
  EXPECT_FALSE(log.spacing.even);
  EXPECT_EQ(log.spacing.stretches.size(), 1U);
  ASSERT_EQ(log.warnings.size(), 1U);
  EXPECT_THAT(log.warnings[0], HasSubstr("the time is not evenly spaced"));
}

// Of stamps with few digits: 1/3 s is 0.333.
TEST(LogTable, FindsThePeriodBehindRoundedTimes) {
  std::string text = kHeader;
  for (int i = 0; i < 3000; ++i) text += fmt::format("{:.3f},{}\n", i / 3.0, i);
  const Log log = log_of(text);
  EXPECT_TRUE(log.spacing.even);
  EXPECT_NEAR(log.spacing.period, 1 / 3.0, 1e-8);
}

TEST(LogTable, RefusesCellsThatAreNoFiniteNumber) {
  for (const char* cell : {"nan", "inf", "-inf", "1e999", "3 N", "x", "1.234,5"}) {
    EXPECT_EQ(refusal(kHeader + rows(12, 5, fmt::format("0.5,\"{}\"", cell))),
              fmt::format("log.csv:7: column 2 (force_N) is '{}', expected a finite number", cell));
  }
  EXPECT_EQ(refusal(kHeader + rows(12, 5, "0.5,")),
            "log.csv:7: column 2 (force_N) is empty, expected a finite number");
  EXPECT_EQ(refusal(kHeader + rows(12, 5, "0.5")), "log.csv:7: 1 fields, the header has 2");
  EXPECT_EQ(refusal(kHeader + rows(12, 5, ",")),
            "log.csv:7: an empty row amid the samples: expected numbers");
}

TEST(LogTable, LeavesOutEmptyRowsAround) {
  const Log log = log_of(kHeader + ",\n\n" + rows(12) + ",\n,\n");
  EXPECT_EQ(log.samples, 12U);
  EXPECT_THAT(log.warnings, ElementsAre("log.csv:2: empty rows before the samples are left out",
                                        "log.csv:16: empty rows behind the samples are left out"));
}

TEST(LogTable, ReadsDecimalCommasBetweenSemicolons) {
  std::string text = "time_s;force_N\n";
  for (int i = 0; i < 12; ++i) text += fmt::format("{},{};-{},5\n", i / 10, i % 10, i);
  const Log log = log_of(text);
  EXPECT_EQ(log.time[11], 1.1);
  EXPECT_EQ(log.columns[0].values[3], -3.5);
  EXPECT_THAT(log.warnings, ElementsAre("log.csv:2: a decimal comma is read as a point, as are 23 "
                                        "further cells"));
}

TEST(LogTable, RefusesDecimalCommasBetweenCommas) {
  EXPECT_EQ(refusal(kHeader + rows(12, 5, "0.5,1,5")),
            "log.csv:7: 3 fields, the header has 2: where commas are decimal, expected ; between "
            "the columns");
}

TEST(LogTable, WarnsOfAConstantColumn) {
  std::string text = kHeader;
  for (int i = 0; i < 10; ++i) text += fmt::format("{},2.5\n", i);
  EXPECT_THAT(log_of(text).warnings,
              ElementsAre("log.csv: column 2 (force_N) is 2.5 N in all samples: nothing can be had "
                          "from it"));
}

TEST(LogTable, RefusesWhatIsNoFile) {
  try {
    read_log(std::filesystem::path("/nowhere/log.csv"));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "log.csv: no such file: expected a log in CSV");
  }
}

// A log that is made up as it is read: what the reader keeps of it is all there is in memory.
class Rows : public std::streambuf {
 public:
  explicit Rows(std::int64_t count) : count_(count), text_("time_us,force_N,travel_mm,a,b\n") {
    setg(text_.data(), text_.data(), text_.data() + text_.size());
  }

 protected:
  int_type underflow() override {
    if (row_ == count_) return traits_type::eof();
    text_ = fmt::format("{},{},{}.5,an unwanted cell,another\n", 500 * row_, row_ % 1000, row_ % 7);
    ++row_;
    setg(text_.data(), text_.data(), text_.data() + text_.size());
    return traits_type::to_int_type(text_.front());
  }

 private:
  std::int64_t count_;
  std::int64_t row_ = 0;
  std::string text_;
};

TEST(LogTable, MayBeLong) {
  constexpr std::size_t kCount = 2'000'000;
  Rows made_up(kCount);
  std::istream in(&made_up);
  const Log log = read_log(in, "log.csv", {.quantities = {"force"}});
  EXPECT_EQ(log.samples, kCount);
  ASSERT_EQ(log.columns.size(), 1U);
  EXPECT_EQ(log.columns[0].values.capacity(), kCount);
  EXPECT_EQ(log.columns[0].values[1'234'567], 567);
  EXPECT_EQ(log.time[1'000'000], 500);
  EXPECT_TRUE(log.spacing.even);
  EXPECT_THAT(log.warnings, IsEmpty());
}

}  // namespace
}  // namespace hvp::files::log_table_test
