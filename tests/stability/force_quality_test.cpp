#include "models/stability/force_quality.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

namespace hvp::stability::force_quality_test {
namespace {

constexpr double kPeriod = 2e-3;

// Frames of a force along z and a tip that moves where it is told to.
struct Felt {
  using Along = std::function<double(int)>;
  explicit Felt(
      int frames, const Along& force, const Along& tip = [](int n) { return 1e-6 * n; },
      double period = kPeriod) {
    for (int n = 0; n < frames; ++n) {
      quality.add({n, period * n, {0, 0, tip(n)}, {0, 0, force(n)}, 7, false, force(n)});
    }
  }
  ForceQuality quality;
};

double at_rest(int /*frame*/) { return 0.04; }

TEST(ForceQuality, OfNoForceHasNothingToSay) {
  const Felt felt(
      500, [](int) { return 0.0; }, at_rest);
  EXPECT_EQ(felt.quality.peak().frame, -1);
  EXPECT_EQ(felt.quality.step_share(), 0);
  EXPECT_EQ(felt.quality.alternations(), 0);
  EXPECT_TRUE(felt.quality.flags().empty());
}

TEST(ForceQuality, NamesTheFramesOfTheLargestForceStepAndPull) {
  const Felt felt(100, [](int n) { return n < 40 ? -0.01 * n : n < 60 ? 0.2 : -0.5; });
  EXPECT_DOUBLE_EQ(felt.quality.peak().value, 0.5);
  EXPECT_EQ(felt.quality.peak().frame, 60);
  EXPECT_DOUBLE_EQ(felt.quality.step().value, 0.7);
  EXPECT_EQ(felt.quality.step().frame, 60);
  EXPECT_DOUBLE_EQ(felt.quality.step_share(), 1.4);
  EXPECT_DOUBLE_EQ(felt.quality.pull().value, 0.2);
  EXPECT_EQ(felt.quality.pull().frame, 40);
}

// On both sides of a tenth.
TEST(ForceQuality, AStepOfMoreThanATenthOfTheLargestForceIsFlagged) {
  for (const double step : {0.09, 0.11}) {
    const Felt felt(200, [&](int n) { return -std::min(1.0, 0.02 * n + (n >= 20 ? step : 0)); });
    EXPECT_EQ(felt.quality.flags().has(Flag::force_step), step + 0.02 > 0.1) << step;
  }
}

// A press of a second whose contact is handed over at 0.5 s while the force moves to `share` of
// itself within `spread`.
ForceQuality handed_over(double share, double spread, bool hands_over = true) {
  ForceQuality quality;
  for (int n = 0; n < 500; ++n) {
    const double t = kPeriod * n;
    const double part = std::clamp((t - 0.5) / spread, 0.0, 1.0);
    const double force = -std::min(t, 0.3) * (1 + (share - 1) * part);
    const int contact = t < 0.05 ? -1 : hands_over && t >= 0.5 ? 8 : 7;
    quality.add({n, t, {0, 0, -1e-2 * std::min(t, 0.3)}, {0, 0, force}, contact, false, 0});
  }
  return quality;
}

// Spread over 30 or 100 ms a step is none from frame to frame, and is felt.
TEST(ForceQuality, AHandOverThatIsFeltIsFlaggedHoweverItIsSpread) {
  for (const double spread : {0.02, 0.03, 0.06, 0.1}) {
    EXPECT_TRUE(handed_over(0.8, spread).flags().has(Flag::force_step)) << spread;
    EXPECT_FALSE(handed_over(0.95, spread).flags().has(Flag::force_step)) << spread;
    // The same change without a hand-over is what the tip has met.
    EXPECT_FALSE(handed_over(0.8, spread, false).flags().has(Flag::force_step)) << spread;
  }
  const ForceQuality quality = handed_over(0.8, 0.03);
  EXPECT_NEAR(quality.handed_over(0).value, 0.2, 0.02);
  EXPECT_NEAR(quality.handed_over(1).value, 0.2, 0.02);
  EXPECT_GE(quality.handed_over(0).frame, 250);
}

// A tip at constant depth begins to slide at 0.5 s: what presses goes to `share` of itself within
// 60 ms, and its friction comes.
ForceQuality begun_to_slide(double share) {
  ForceQuality quality;
  for (int n = 0; n < 500; ++n) {
    const double t = kPeriod * n;
    const double part = std::clamp((t - 0.5) / 0.06, 0.0, 1.0);
    const double presses = 0.3 * (1 + (share - 1) * part);
    FeltForce felt{n, t, {part, 0, -1e-2}, {part * presses, 0, -presses}, t < 0.5 ? 7 : 8};
    felt.foot = {part, 0, 0};
    felt.normal = Eigen::Vector3d::UnitZ();
    quality.add(felt);
  }
  return quality;
}

TEST(ForceQuality, FrictionThatComesIsNoStepAndWhatPressesIs) {
  EXPECT_FALSE(begun_to_slide(1.0).flags().has(Flag::force_step));
  EXPECT_NEAR(begun_to_slide(1.0).handed_over(0).value, 0, 1e-12);
  EXPECT_TRUE(begun_to_slide(0.8).flags().has(Flag::force_step));
}

// A press that begins and ends changes the force by all of it, with a hand-over on the way.
TEST(ForceQuality, AHandOverWithinAPressIsNotBlamedForThePress) {
  const auto smooth = [](double t) { return t * t * t * (10 - 15 * t + 6 * t * t); };
  ForceQuality quality;
  for (int n = 0; n < 500; ++n) {
    const double depth = 5e-3 * smooth(std::min(1.0, kPeriod * n / 0.5));
    const int contact = n == 0 ? -1 : n < 150 ? 7 : 8;
    quality.add({n, kPeriod * n, {0, 0, -depth}, {0, 0, -100 * depth}, contact, false, 0});
  }
  EXPECT_FALSE(quality.flags().has(Flag::force_step))
      << quality.handed_over(0).value << " " << quality.handed_over(1).value;
}

TEST(ForceQuality, ASmoothMotionHasNoFlag) {
  // A press, a hold and a release of a tenth of a second each, by minimum jerk.
  const auto smooth = [](double t) { return t * t * t * (10 - 15 * t + 6 * t * t); };
  const Felt felt(
      600,
      [&](int n) {
        return n < 200 ? -smooth(n / 200.0) : n < 400 ? -1.0 : -smooth((600 - n) / 200.0);
      },
      [](int n) { return n < 200   ? 1e-4 * n
                         : n < 400 ? 0.02
                                   : 1e-4 * (600 - n); });
  EXPECT_TRUE(felt.quality.flags().empty()) << felt.quality.flags().bits();
  ASSERT_TRUE(felt.quality.ripple());
  EXPECT_EQ(*felt.quality.ripple(), 0);
}

// Alternations of 3 % of the force, far from a step of 10 %.
TEST(ForceQuality, AForceThatTurnsFromFrameToFrameRings) {
  const auto ringing = [](int frames) {
    return Felt(1000, [=](int n) {
      return -1.0 + (n >= 500 && n < 500 + frames ? 0.015 * (n % 2 ? 1 : -1) : 0);
    });
  };
  EXPECT_EQ(ringing(5).quality.alternations(), 2);
  EXPECT_FALSE(ringing(5).quality.flags().has(Flag::force_ringing));
  EXPECT_TRUE(ringing(40).quality.flags().has(Flag::force_ringing));
  EXPECT_FALSE(ringing(40).quality.flags().has(Flag::force_step));
}

// What is below two hundredths of the largest force is not counted, whenever that comes.
TEST(ForceQuality, AlternationsAreJudgedByTheLargestForceOfTheRun) {
  const auto run = [](double largest) {
    return Felt(1000, [=](int n) { return n < 500 ? -0.5 + 0.01 * (n % 2 ? 1 : -1) : -largest; });
  };
  EXPECT_TRUE(run(0.5).quality.flags().has(Flag::force_ringing));
  EXPECT_FALSE(run(5.0).quality.flags().has(Flag::force_ringing));
}

// A tremor of a hand turns some ten times a second, at any servo rate that shows it.
TEST(ForceQuality, ATremorIsNoRinging) {
  for (const double period : {1e-4, 1e-3, 2e-3, 10e-3}) {
    const Felt felt(
        static_cast<int>(4 / period),
        [&](int n) { return -1.0 + 0.2 * std::sin(2 * 3.14159265 * 12 * period * n); },
        [&](int n) { return 0.01 * std::sin(2 * 3.14159265 * 12 * period * n); }, period);
    EXPECT_FALSE(felt.quality.flags().has(Flag::force_ringing)) << period;
  }
}

TEST(ForceQuality, AForceThatMovesOnWhileTheTipRestsIsALimitCycle) {
  const auto cycle = [](double amplitude) {
    return Felt(
        600, [=](int n) { return -1 + amplitude * std::sin(0.7 * n); }, at_rest);
  };
  EXPECT_NEAR(*cycle(0.01).quality.ripple(), 0.02, 0.001);
  EXPECT_TRUE(cycle(0.01).quality.flags().has(Flag::limit_cycle));
  EXPECT_FALSE(cycle(0.005).quality.flags().has(Flag::limit_cycle));
}

// Twice the window, at least.
TEST(ForceQuality, AShortRestShowsNoCycle) {
  const auto cycle = [](int frames) {
    return Felt(
        frames, [](int n) { return -1 + 0.05 * std::sin(0.7 * n); }, at_rest);
  };
  EXPECT_FALSE(cycle(170).quality.ripple());
  EXPECT_TRUE(cycle(190).quality.ripple());
}

// 9 Hz at 3 % of critical damping, the default material's: it settles.
TEST(ForceQuality, ABodyThatSwingsDownIsNoLimitCycle) {
  const Felt felt(
      2000,
      [](int n) {
        return -1 + 0.3 * std::exp(-1.7 * kPeriod * n) * std::sin(2 * 3.14159265 * 9 * kPeriod * n);
      },
      at_rest);
  EXPECT_FALSE(felt.quality.flags().has(Flag::limit_cycle)) << *felt.quality.ripple();
}

TEST(ForceQuality, ATipThatMovesOrAnotherContactIsNoRest) {
  const Felt creeping(
      600, [](int n) { return -1 + 0.05 * std::sin(0.7 * n); }, [](int n) { return 1e-9 * n; });
  EXPECT_FALSE(creeping.quality.ripple());
  ForceQuality sliding;
  for (int n = 0; n < 600; ++n) {
    sliding.add({n, kPeriod * n, {0, 0, 0.04}, {0, 0, -1 + 0.05 * std::sin(0.7 * n)}, n / 100, 0});
  }
  EXPECT_FALSE(sliding.ripple());
}

}  // namespace
}  // namespace hvp::stability::force_quality_test
