// Which drawn times a late frame counts as much as.
#include "vp/frame/rare_misses.h"

#include <cstdint>

#include <gtest/gtest.h>

#include "models/random/tilt.h"
#include "tests/vp/path_of.h"

namespace hvp::vp::rare_misses_test {
namespace {

constexpr Picoseconds kBudget = 1000;

class RareMissesOf : public ::testing::Test {
 protected:
  // Every block of two frames has a weight of its own.
  RareMissesOf() {
    for (std::int64_t n = 0; n < 200; ++n) tilt_.share(0, n, 0, 1 / (2.0 + static_cast<double>(n)));
  }
  void close(std::int64_t number, bool late, bool beyond_tick = false, hvp_status status = HVP_OK) {
    Frame f;
    f.number = number;
    f.beyond_tick = beyond_tick;
    f.status = status;
    f.spans.push_back({Part::host, Phase::force, 0, late ? kBudget + 1 : kBudget, kBirth});
    f.force_at_motor = 0;
    misses_.closed(f, path_of(f));
  }

  random::Tilt tilt_{{.share = 0.5, .frames = 2, .seed = 1, .draws = {1}}};
  RareMisses misses_{tilt_, kBudget};
};

TEST_F(RareMissesOf, AFrameCountAsTheTimesAroundIt) {
  for (std::int64_t n = 0; n < 60; ++n) close(n, n == 30);
  EXPECT_DOUBLE_EQ(misses_.late(), tilt_.weight(22, 34));
  EXPECT_NE(misses_.late(), tilt_.weight(30, 30));
  EXPECT_EQ(misses_.seen(), 1);
  EXPECT_EQ(misses_.frames(), 60);
}

// What made the first of a row late may have made the last one late.
TEST_F(RareMissesOf, ARowCountFromItsFirst) {
  for (std::int64_t n = 0; n < 80; ++n) close(n, n == 40 || n == 43, n == 41 || n == 42);
  EXPECT_DOUBLE_EQ(misses_.late(), tilt_.weight(32, 44) + tilt_.weight(32, 47));
  EXPECT_EQ(misses_.seen(), 2);
}

TEST_F(RareMissesOf, TwoRowsCountEachFromItsOwn) {
  for (std::int64_t n = 0; n < 80; ++n) close(n, n == 40 || n == 42);
  EXPECT_DOUBLE_EQ(misses_.late(), tilt_.weight(32, 44) + tilt_.weight(34, 46));
}

// A frame that failed may hold up those behind it, and is none that is counted.
TEST_F(RareMissesOf, AFailedFrameBeginsARow) {
  for (std::int64_t n = 0; n < 80; ++n) {
    close(n, n == 41, false, n == 40 ? HVP_ERROR_TIMEOUT : HVP_OK);
  }
  EXPECT_DOUBLE_EQ(misses_.late(), tilt_.weight(32, 45));
  EXPECT_EQ(misses_.left_out(), 1);
  EXPECT_EQ(misses_.frames(), 79);
}

}  // namespace
}  // namespace hvp::vp::rare_misses_test
