#include <cmath>

#include <gtest/gtest.h>

#include "models/collision/hand_over.h"

namespace hvp::collision {
namespace {

const Eigen::Vector3d kGap(1e-3, -2e-3, 5e-3);
constexpr std::int64_t kStart = 7'000'000'000;
constexpr std::int64_t kDuration = 30'000'000'000;

TEST(HandOver, ClosesTheWholeGapInItsDuration) {
  HandOver h;
  EXPECT_EQ(h.gap(kStart), Eigen::Vector3d::Zero());  // nothing was ever handed over
  h.begin(kStart, kDuration, kGap);
  EXPECT_EQ(h.gap(kStart), kGap);
  EXPECT_NEAR((h.gap(kStart + kDuration / 2) - 0.5 * kGap).norm(), 0, 1e-15);
  EXPECT_EQ(h.gap(kStart + kDuration), Eigen::Vector3d::Zero());
  EXPECT_EQ(h.gap(kStart + 10 * kDuration), Eigen::Vector3d::Zero());
}

TEST(HandOver, StartsAndEndsWithoutVelocityOrAcceleration) {
  HandOver h;
  h.begin(kStart, kDuration, kGap);
  const std::int64_t step = kDuration / 1000;
  // A cubic start: within a thousandth of the time it moves by at most ten billionths of the gap.
  EXPECT_LT((h.gap(kStart + step) - kGap).norm(), 1.1e-8 * kGap.norm());
  EXPECT_LT(h.gap(kStart + kDuration - step).norm(), 1.1e-8 * kGap.norm());
}

TEST(HandOver, NeverGoesBackOrBeyond) {
  HandOver h;
  h.begin(kStart, kDuration, kGap);
  double last = 1;
  for (int i = 1; i <= 100; ++i) {
    const double share = h.gap(kStart + i * (kDuration / 100)).norm() / kGap.norm();
    EXPECT_LE(share, last);
    last = share;
  }
}

TEST(HandOver, OfNoDurationJumpsAsTheThesisDoes) {
  HandOver h;
  h.begin(kStart, 0, kGap);
  EXPECT_EQ(h.gap(kStart), Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace hvp::collision
