#include "models/statistics/histogram.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace hvp::statistics::histogram_test {
namespace {

TEST(Histogram, PercentilesAreWithinAPartInSixtyFour) {
  Histogram h;
  for (std::int64_t t = 1; t <= 1'000'000; t += 7) h.add(t * 1000);
  EXPECT_EQ(h.count(), 142'858);
  EXPECT_EQ(h.largest(), 1'000'000'000);
  for (const double share : {0.01, 0.25, 0.5, 0.9, 0.99, 0.999}) {
    const double exact = share * 1e9;
    EXPECT_NEAR(static_cast<double>(h.percentile(share)), exact, exact / 64 + 7000) << share;
  }
  EXPECT_EQ(h.percentile(1), h.largest());
  EXPECT_NEAR(h.mean(), 5e8, 1e4);
}

TEST(Histogram, SmallTimesAreExact) {
  Histogram h;
  for (std::int64_t t = 0; t < 64; ++t) h.add(t);
  EXPECT_EQ(h.percentile(0.5), 31);
  EXPECT_EQ(h.percentile(1), 63);
}

TEST(Histogram, OneTimeIsEveryPercentile) {
  Histogram h;
  h.add(1'234'567'890'123);
  EXPECT_EQ(h.percentile(0.01), 1'234'567'890'123);
  EXPECT_EQ(h.percentile(0.99), 1'234'567'890'123);
  EXPECT_EQ(Histogram().percentile(0.5), 0);
}

TEST(Histogram, PartsHoldEveryTimeOnceAndDoNotOverlap) {
  Histogram h;
  for (std::int64_t t = 1; t < std::int64_t{1} << 40; t *= 3) h.add(t, 2);
  std::int64_t sum = 0;
  std::int64_t before = 0;
  for (const Histogram::Part& part : h.parts()) {
    EXPECT_GE(part.from, before);
    EXPECT_LE(64 * (part.below - part.from), std::max<std::int64_t>(part.from, 64));
    before = part.below;
    sum += part.count;
  }
  EXPECT_EQ(sum, h.count());
  Histogram one;
  one.add(1'000'003);
  ASSERT_EQ(one.parts().size(), 1U);
  EXPECT_LE(one.parts()[0].from, 1'000'003);
  EXPECT_GT(one.parts()[0].below, 1'000'003);
}

TEST(Histogram, ATimeThatOccursOftenIsAddedOnce) {
  Histogram h;
  h.add(10, 99);
  h.add(1000);
  h.add(5'000'000, 0);
  EXPECT_EQ(h.count(), 100);
  EXPECT_EQ(h.percentile(0.99), 10);
  EXPECT_EQ(h.largest(), 1000);
  EXPECT_DOUBLE_EQ(h.mean(), 19.9);
}

TEST(Histogram, OctavesHoldEveryTimeOnce) {
  Histogram h;
  for (std::int64_t t = 1; t < std::int64_t{1} << 40; t *= 3) h.add(t);
  h.add(0);
  h.add(std::int64_t{1} << 62);
  std::int64_t sum = 0;
  std::int64_t before = -1;
  for (const Histogram::Octave& o : h.octaves()) {
    EXPECT_GT(o.from, before);
    before = o.from;
    sum += o.count;
  }
  EXPECT_EQ(sum, h.count());
  EXPECT_EQ(before, std::int64_t{1} << 62);
  // 64 to 127 ps: 81 alone.
  Histogram one;
  one.add(81);
  ASSERT_EQ(one.octaves().size(), 1U);
  EXPECT_EQ(one.octaves()[0].from, 64);
}

}  // namespace
}  // namespace hvp::statistics::histogram_test
