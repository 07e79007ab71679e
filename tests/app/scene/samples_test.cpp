#include "app/scene/samples.h"

#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/app/scratch_directory.h"

namespace hvp::app::samples_test {
namespace {

Samples table(const std::string& text) {
  const ScratchDirectory place;
  const std::filesystem::path file = place.path() / "log.csv";
  std::ofstream(file, std::ios::binary) << text;
  return read_samples(file);
}

std::vector<double> samples(const std::string& text) {
  const Samples read = table(text);
  EXPECT_TRUE(read.counts.empty());
  return read.times_s;
}

std::string refusal(const std::string& text) {
  try {
    samples(text);
  } catch (const InputError& e) {
    EXPECT_EQ(e.key(), "samples");
    return e.what();
  }
  return "taken";
}

TEST(Samples, AreTheColumnWithAUnit) {
  EXPECT_EQ(samples("late_us\n1.5\n20\n"), (std::vector<double>{1.5e-6, 20e-6}));
  EXPECT_EQ(samples("t_ms\n0\n"), (std::vector<double>{0}));
  EXPECT_EQ(samples("t_s\n1\n"), (std::vector<double>{1}));
}

// A log has the time of each sample: the latencies are drawn, not the times.
TEST(Samples, AreTheLatenciesOfALog) {
  EXPECT_EQ(samples("time_s,latency_us\n0.000,4\n0.9,5\n"), (std::vector<double>{4e-6, 5e-6}));
  EXPECT_EQ(samples("latency_ns,time_ms\n250,1\n3e3,2\n"), (std::vector<double>{250e-9, 3e-6}));
}

TEST(Samples, AreWeighedByTheirCounts) {
  const Samples read = table("latency_us,count\n4,200000\n5,0\n900,1\n");
  EXPECT_EQ(read.times_s, (std::vector<double>{4e-6, 900e-6}));
  EXPECT_EQ(read.counts, (std::vector<std::int64_t>{200000, 1}));
}

// What did not fit into the histogram is as long as the longest of all.
TEST(Samples, AreWhatCyclictestPrints) {
  const std::string histogram = "# Histogram\n000002 000101\n000003 000007\n";
  const Samples read = table(histogram + "# Max Latencies: 00057\n# Histogram Overflows: 00003\n");
  ASSERT_EQ(read.times_s.size(), 3U);
  EXPECT_DOUBLE_EQ(read.times_s[1], 3e-6);
  EXPECT_DOUBLE_EQ(read.times_s[2], 57e-6);
  EXPECT_EQ(read.counts, (std::vector<std::int64_t>{101, 7, 3}));
  EXPECT_NE(refusal(histogram + "# Histogram Overflows: 00003\n").find("beyond the histogram"),
            std::string::npos);
}

TEST(Samples, ComeFromEveryProgram) {
  const std::vector<double> expected = {1.5e-3, 2e-3};
  EXPECT_EQ(samples("\xEF\xBB\xBFt_ms\r\n1.5\r\n2\r\n"), expected);
  EXPECT_EQ(samples("time_s;latency_ms\n1;1.5\n2;2\n"), expected);
  EXPECT_EQ(samples("# of a rig\nt_ms\n1.5\n2\n"), expected);
}

TEST(Samples, RefusalsNameTheLine) {
  EXPECT_NE(refusal("").find("no line of numbers"), std::string::npos);
  EXPECT_NE(refusal("1\n2\n").find("line 1: "), std::string::npos);
  EXPECT_NE(refusal("t_us\n1\n-1\n").find("line 3: "), std::string::npos);
  EXPECT_NE(refusal("t_us\n1\n2 us\n").find("line 3: "), std::string::npos);
  EXPECT_NE(refusal("t_s\n1.5\n").find("found '1.5'"), std::string::npos);
  EXPECT_NE(refusal("time_s,latency_us\n1\n").find("line 2: "), std::string::npos);
  EXPECT_NE(refusal("t_us\nnan\n").find("line 2: "), std::string::npos);
  EXPECT_NE(refusal("t_us\n\n").find("no sample"), std::string::npos);
  EXPECT_EQ(refusal("t_us\n3\n5 m\n"),
            "log.csv: line 3: expected a latency from 0 to 1 s, found '5 m'");
}

// A column that nobody knows may mean that a row is not what it is taken for.
TEST(Samples, RefuseColumnsThatAreNotKnown) {
  EXPECT_NE(refusal("number,late_us\n1,250\n").find("column 1 is called 'number'"),
            std::string::npos);
  EXPECT_NE(refusal("late_ns,other_s\n1,2\n").find("2 columns of times, late_ns, other_s"),
            std::string::npos);
}

}  // namespace
}  // namespace hvp::app::samples_test
