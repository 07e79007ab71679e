#include "models/fit/wake_up_histogram.h"

#include <random>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fit/wake_up_fit.h"

namespace hvp::fit::wake_up_histogram_test {
namespace {

WakeUpHistogram read_wake_up_histogram(std::string_view text) {
  return histogram_of(files::read_latencies(text));
}

// In the form that cyclictest(8) of rt-tests prints.
constexpr const char* kCyclictest =
    "# /dev/cpu_dma_latency set to 0us\n"
    "policy: fifo: loadavg: 0.00 0.01 0.05 1/100 4242\n"
    "T: 0 ( 4243) P:80 I:1000 C: 100000 Min: 2 Act: 3 Avg: 3 Max: 57\n"
    "# Histogram\n"
    "000000 000000\t000000\n"
    "000001 000000\t000002\n"
    "000002 000101\t000050\n"
    "000003 000200\t000007\n"
    "\n"
    "# Total: 000000301 000000059\n"
    "# Min Latencies: 00002 00001\n"
    "# Avg Latencies: 00003 00002\n"
    "# Max Latencies: 00057 00003\n"
    "# Histogram Overflows: 00002 00001\n"
    "# Histogram Overflow at cycle number:\n"
    "# Thread 0: 12 77\n";

TEST(WakeUpHistogram, AddsUpCyclictestsProcessors) {
  const WakeUpHistogram h = read_wake_up_histogram(kCyclictest);
  ASSERT_EQ(h.bins.size(), 4U);
  EXPECT_DOUBLE_EQ(h.bins[2].from, 2e-6);
  EXPECT_DOUBLE_EQ(h.bins[2].to, 3e-6);
  EXPECT_EQ(h.bins[2].count, 151);
  EXPECT_EQ(h.count(), 360);
  EXPECT_EQ(h.overflows, 3);
  ASSERT_TRUE(h.longest);
  EXPECT_DOUBLE_EQ(*h.longest, 57e-6);
  EXPECT_TRUE(h.warnings.empty());
}

// In the form that `rtla timerlat hist` prints; rows without a sample are left out.
constexpr const char* kTimerlat =
    "# RTLA timerlat histogram\n"
    "# Time unit is microseconds (us)\n"
    "# Duration:   0 00:00:10\n"
    "Index   IRQ-000   Thr-000   IRQ-001   Thr-001\n"
    "0           500         0       480         0\n"
    "1            10       300        20       250\n"
    "2             1       200         3       240\n"
    "7             0         7         0         9\n"
    "over:         0         2         0         1\n"
    "count:      511       509       503       500\n"
    "min:          0         1         0         1\n"
    "avg:          0         1         0         1\n"
    "max:          2        31         2        57\n"
    "ALL:        IRQ       Thr\n"
    "count:     1014      1009\n"
    "max:          2        57\n";

TEST(WakeUpHistogram, ReadsTimerlatsThreads) {
  const WakeUpHistogram h = read_wake_up_histogram(kTimerlat);
  ASSERT_EQ(h.bins.size(), 4U);
  EXPECT_EQ(h.bins[0].count, 0);
  EXPECT_EQ(h.bins[1].count, 550);
  EXPECT_DOUBLE_EQ(h.bins[2].to, 3e-6);
  EXPECT_DOUBLE_EQ(h.bins[3].from, 7e-6);
  EXPECT_EQ(h.bins[3].count, 16);
  EXPECT_EQ(h.overflows, 3);
  EXPECT_DOUBLE_EQ(*h.longest, 57e-6);
}

TEST(WakeUpHistogram, PrefersTimerlatsUserSpace) {
  const WakeUpHistogram h = read_wake_up_histogram(
      "# Time unit is nanoseconds (ns)\n"
      "Index IRQ-003 Thr-003 Usr-003\n"
      "1000 9 8 1\n1500 7 6 2\n3000 0 0 4\n"
      "over: 0 0 0\nmax: 1700 1900 3400\n");
  EXPECT_EQ(h.count(), 7);
  EXPECT_DOUBLE_EQ(h.bins[0].to, 1500e-9);
  EXPECT_DOUBLE_EQ(h.bins[2].to, 3500e-9);
  EXPECT_DOUBLE_EQ(*h.longest, 3.4e-6);
}

TEST(WakeUpHistogram, RefusesWhatIsNoTimerlatHistogram) {
  const auto message = [](std::string_view text) -> std::string {
    try {
      read_wake_up_histogram(text);
    } catch (const InputError& e) {
      return e.what();
    }
    return "none";
  };
  EXPECT_EQ(message("# RTLA osnoise histogram\nIndex CPU-000\n0 5\n"),
            "line 1: '# RTLA osnoise histogram' has no latencies: expected rtla timerlat's");
  EXPECT_EQ(message("Index IRQ-000\n0 5\n"),
            "line 1: no column of a thread, as Thr-000 is: an interrupt's latency is not when a "
            "process runs");
  EXPECT_EQ(message("# RTLA timerlat histogram\n0 5\n"),
            "line 2: expected the names of the columns, which begin with Index, before the counts");
  EXPECT_EQ(message("Index Thr-000\n0 5 6\n"), "line 2: 3 columns: expected 2 as the names are");
  EXPECT_EQ(message("Index Thr-000\n2 5\n2 6\n"),
            "line 3: the latency is 2 us after 2 us: expected it to grow");
  EXPECT_EQ(message("Index Thr-000\n2 -5\n"),
            "line 2: the count is '-5': expected a whole number from 0 on");
  EXPECT_EQ(message("Index Thr-000\nover: 1\n"), "no line of a latency and its counts");
}

TEST(WakeUpHistogram, RefusesALongestLatencyBeyondASecond) {
  try {
    read_wake_up_histogram("000001 000002\n# Max Latencies: 99999999\n");
    ADD_FAILURE();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "line 2: expected a latency from 0 to 1 s, found '99999999'");
  }
}

TEST(WakeUpHistogram, LeavesOutTheColumnOfSums) {
  const WakeUpHistogram h = read_wake_up_histogram(
      "000001 000000 000002 000002\n000002 000101 000050 000151\n000003 000200 000007 000207\n");
  EXPECT_EQ(h.count(), 360);
  EXPECT_EQ(h.warnings.size(), 1U);
}

TEST(WakeUpHistogram, ReadsCsvInItsUnit) {
  const WakeUpHistogram h =
      read_wake_up_histogram("latency_ns,count\r\n500,3\r\n1000,8\r\n2500,1\r\n");
  ASSERT_EQ(h.bins.size(), 3U);
  EXPECT_DOUBLE_EQ(h.bins[0].from, 0.5e-6);
  EXPECT_DOUBLE_EQ(h.bins[1].to, 1.5e-6);
  EXPECT_EQ(h.count(), 12);
  EXPECT_EQ(h.overflows, 0);
  EXPECT_FALSE(h.longest);
}

// A log of single latencies is the histogram of its values.
TEST(WakeUpHistogram, OfALogWithTimeStampsIsThatOfItsLatencies) {
  const WakeUpHistogram h =
      read_wake_up_histogram("time_s,latency_us\n0.000,5\n0.001,4\n0.002,5\n");
  ASSERT_EQ(h.bins.size(), 2U);
  EXPECT_DOUBLE_EQ(h.bins[0].from, 4e-6);
  EXPECT_EQ(h.bins[1].count, 2);
}

void expect_refused(const std::string& text, const std::string& words) {
  try {
    read_wake_up_histogram(text);
    ADD_FAILURE() << "not refused: " << text;
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
  }
}

TEST(WakeUpHistogram, RefusesWhatIsNone) {
  expect_refused("", "no line of numbers");
  expect_refused("# Histogram\n", "no line of numbers");
  expect_refused("hello world\n", "line 1");
  expect_refused("time_s,force_N\n0,1\n", "line 1");
  expect_refused("1 5\n2\n", "line 2");
  expect_refused("1 5\n2 -3\n", "line 2");
  expect_refused("1 5\n2 3.5\n", "line 2");
  expect_refused("1 5\n2 99999999999999999999999\n", "line 2");
  expect_refused("1 5\n1 3\n", "grow");
  expect_refused("1 5\n2 3 4\n", "columns");
  expect_refused("-1 5\n", "latency");
  expect_refused("nan 5\n", "line 1");
  expect_refused("1e300 5\n", "latency");
  expect_refused("5000000 5\n", "latency");
  expect_refused("latency_us,count\n1,5,7\n2,3,4\nlatency_us,count\n", "line 2");
  expect_refused("latency_us,count\n1,5\nlatency_us,count\n", "line 3");
}

// A damaged file is read or refused, and what is read is fitted or refused.
TEST(WakeUpHistogram, DamagedFilesAreReadOrRefused) {
  std::mt19937 generator(1);
  int read = 0;
  for (int n = 0; n < 4000; ++n) {
    std::string text = n % 2 == 0 ? kCyclictest : "latency_us,count\n1,500\n2,800\n4,30\n9,1\n";
    for (int k = 0; k < 1 + n % 3; ++k) {
      constexpr std::string_view kBytes = "0123456789 -.e,\t\n#\xff";
      const std::size_t at = generator() % text.size();
      text[at] = kBytes[generator() % kBytes.size()];
      if (generator() % 4 == 0) text.erase(at, generator() % 20);
      if (text.empty()) break;
    }
    try {
      const WakeUpHistogram h = read_wake_up_histogram(text);
      ++read;
      const WakeUpFit fitted = fit_wake_up(h);
      EXPECT_NO_THROW(fitted.distribution.check()) << text;
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(read, 500);
}

}  // namespace
}  // namespace hvp::fit::wake_up_histogram_test
