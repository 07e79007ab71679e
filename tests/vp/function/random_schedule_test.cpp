#include "vp/function/random_schedule.h"

#include <cstdint>

#include <gtest/gtest.h>

namespace hvp::vp::random_schedule_test {
namespace {

constexpr std::int64_t kDraws = 100'000;
constexpr Picoseconds kShortest = 100'000;       // 100 ns
constexpr Picoseconds kLongest = 1'000'000'000;  // 1 ms
constexpr Picoseconds kMiddle = 10'000'000;      // 10 us, their geometric mean

TEST(RandomSchedule, OneTimeInEightIsUniformInItsLogarithm) {
  RandomSchedule schedule(1, "guest.schedule", 1e-3);
  std::int64_t delayed = 0;
  std::int64_t below = 0;
  for (std::int64_t i = 0; i < kDraws; ++i) {
    const Picoseconds time = schedule.next();
    if (time == 0) continue;
    ++delayed;
    EXPECT_GE(time, kShortest);
    EXPECT_LE(time, kLongest);
    if (time < kMiddle) ++below;
  }
  // Five standard deviations.
  EXPECT_NEAR(static_cast<double>(delayed), 12'500, 525);
  EXPECT_NEAR(static_cast<double>(below), static_cast<double>(delayed) / 2, 290);
}

TEST(RandomSchedule, ATimeIsThatOfItsSeedStreamAndNumber) {
  const auto sum = [](std::int64_t seed, const char* stream) {
    RandomSchedule schedule(seed, stream, 1e-3);
    Picoseconds all = 0;
    for (int i = 0; i < 100; ++i) all += schedule.next();
    return all;
  };
  EXPECT_EQ(sum(1, "a"), sum(1, "a"));
  EXPECT_NE(sum(1, "a"), sum(2, "a"));
  EXPECT_NE(sum(1, "a"), sum(1, "b"));
}

}  // namespace
}  // namespace hvp::vp::random_schedule_test
