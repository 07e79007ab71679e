#include "models/collision/hand_over.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace hvp::collision::hand_over_test {
namespace {

using Eigen::Vector3d;

constexpr std::int64_t kFrame = 2'000'000'000;
constexpr std::int64_t kLast = 7 * kFrame;
constexpr std::int64_t kDuration = 30'000'000'000;
constexpr double kDurationSeconds = 30e-3;

// Two nodes of three: the tip moves at 0.1 m/s downwards, the nodes each their own way.
struct Touch {
  explicit Touch(std::int64_t duration = kDuration) : hand_over(duration) {
    hand_over.change(nodes, aim(kLast - kFrame), aim(kLast), u, v);
  }
  static Aim aim(std::int64_t time) {
    return {time, {2e-3, 0, -1e-4 * static_cast<double>(time) / 1e9}};
  }
  Vector3d place(std::int64_t time, std::size_t node) {
    return hand_over.hold(aim(time), 2e-3).displacement[node];
  }

  std::array<int, 2> nodes = {0, 2};
  std::array<double, 9> u = {1e-3, -2e-3, 5e-3, 9, 9, 9, -3e-3, 0, 1e-3};
  std::array<double, 9> v = {0.3, 0, -0.2, 9, 9, 9, 0, 0.1, 0};
  HandOver hand_over;
};

TEST(HandOver, TakesEveryNodeFromWhereItIsToTheAim) {
  Touch touch;
  for (const std::size_t node : {0U, 1U}) {
    const std::size_t at = node == 0 ? 0 : 6;
    EXPECT_LT((touch.place(kLast, node) - Vector3d(&touch.u[at])).norm(), 1e-17);
  }
  for (const std::int64_t after : {kDuration, 2 * kDuration, 100 * kDuration}) {
    const fem::Hold hold = touch.hand_over.hold(Touch::aim(kLast + after), 2e-3);
    for (const Vector3d& u : hold.displacement)
      EXPECT_EQ(u, Touch::aim(kLast + after).displacement);
  }
}

// By differences: the velocity is the node's at the beginning and the aim's at the end; the
// acceleration is that of the aim, none, at both.
TEST(HandOver, JumpsNeitherInVelocityNorInAcceleration) {
  Touch touch;
  const std::int64_t step = kDuration / 10'000;
  const double h = kDurationSeconds / 10'000;
  const auto place = [&](std::int64_t n) { return touch.place(kLast + n * step, 0); };
  const Vector3d begins = (-3 * place(0) + 4 * place(1) - place(2)) / (2 * h);
  EXPECT_LT((begins - Vector3d(&touch.v[0])).norm(), 1e-5);
  const Vector3d ends = (3 * place(10'000) - 4 * place(9'999) + place(9'998)) / (2 * h);
  EXPECT_LT((ends - Vector3d(0, 0, -0.1)).norm(), 1e-5);
  // Half-way it is hundreds of times that, m/s².
  const auto bend = [&](std::int64_t n) {
    return ((place(n + 1) - 2 * place(n) + place(n - 1)) / (h * h)).norm();
  };
  EXPECT_LT(bend(1), 0.1);
  EXPECT_LT(bend(9'999), 0.1);
  EXPECT_GT(bend(2'500), 10);
}

// A body without mass has no velocity that could be matched: the gap alone closes.
TEST(HandOver, WithoutVelocityTheGapClosesMonotonically) {
  Touch touch;
  touch.hand_over.change(touch.nodes, Touch::aim(kLast - kFrame), Touch::aim(kLast), touch.u, {});
  double last = 1;
  const Vector3d gap = Vector3d(&touch.u[0]) - Touch::aim(kLast).displacement;
  for (int i = 1; i <= 100; ++i) {
    const Aim aim = Touch::aim(kLast + i * (kDuration / 100));
    const double share =
        (touch.hand_over.hold(aim, 2e-3).displacement[0] - aim.displacement).norm() / gap.norm();
    EXPECT_LE(share, last);
    last = share;
  }
  EXPECT_EQ(last, 0);
}

TEST(HandOver, NodesLetGoKeepAShareOfTheirForceThatFallsToZero) {
  Touch touch;
  const std::array<int, 2> next = {1, 2};
  touch.hand_over.hold(Touch::aim(kLast + kFrame), 2e-3);
  touch.hand_over.change(next, Touch::aim(kLast), Touch::aim(kLast + kFrame), touch.u, touch.v);
  double last = 1;
  for (std::int64_t n = 1; n < 15; ++n) {
    const fem::Hold hold = touch.hand_over.hold(Touch::aim(kLast + kFrame + n * kFrame), 2e-3);
    ASSERT_EQ(hold.let_go.size(), 1U) << n;
    EXPECT_EQ(hold.let_go[0].node, 0);
    EXPECT_LT(hold.let_go[0].share, last);
    EXPECT_GT(hold.let_go[0].share, 0);
    last = hold.let_go[0].share;
    EXPECT_TRUE(touch.hand_over.under_way(kLast + (n + 1) * kFrame));
  }
  EXPECT_TRUE(touch.hand_over.hold(Touch::aim(kLast + 16 * kFrame), 2e-3).let_go.empty());
  EXPECT_FALSE(touch.hand_over.under_way(kLast + 16 * kFrame));
}

// Nothing is felt twice: a node that is held again has its own force again.
TEST(HandOver, NodesThatComeBackFadeNoMore) {
  Touch touch;
  const std::array<int, 1> other = {1};
  touch.hand_over.change(other, Touch::aim(kLast), Touch::aim(kLast + kFrame), touch.u, touch.v);
  touch.hand_over.change(touch.nodes, Touch::aim(kLast + kFrame), Touch::aim(kLast + 2 * kFrame),
                         touch.u, touch.v);
  const fem::Hold hold = touch.hand_over.hold(Touch::aim(kLast + 3 * kFrame), 2e-3);
  ASSERT_EQ(hold.let_go.size(), 1U);
  EXPECT_EQ(hold.let_go[0].node, 1);
}

TEST(HandOver, OfNoDurationJumpsAsTheThesisDoes) {
  Touch touch(0);
  const fem::Hold hold = touch.hand_over.hold(Touch::aim(kLast), 2e-3);
  for (const Vector3d& u : hold.displacement) EXPECT_EQ(u, Touch::aim(kLast).displacement);
  EXPECT_EQ(hold.elapsed_s, 0) << "held nodes keep Newmark's own velocity";
  touch.hand_over.change({}, Touch::aim(kLast), Touch::aim(kLast + kFrame), touch.u, touch.v);
  EXPECT_TRUE(touch.hand_over.hold(Touch::aim(kLast + kFrame), 2e-3).let_go.empty());
}

}  // namespace
}  // namespace hvp::collision::hand_over_test
