// What of a closed loop is called a cycle, a drift and energy out of nowhere.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "models/plant/loop_quality.h"

namespace hvp::plant::oscillation_test {
namespace {

using std::numbers::pi;

constexpr double kPeriod = 1e-3;

// A tip at rest in x whose z is `z` of the time.
template <typename Path>
RestWatch rest(const Path& z, double seconds = 1) {
  RestWatch watch;
  for (int n = 0; n < seconds / kPeriod; ++n) {
    watch.add(n, n * kPeriod, {0, 0, z(n * kPeriod)}, true);
  }
  return watch;
}

using Verdict = RestWatch::Verdict;

// The same for a second, in the shortest windows.
template <typename Path>
Oscillation watched(const Path& z) {
  Oscillation oscillation;
  for (int n = 0; n < 1000; ++n) {
    oscillation.add(n, n * kPeriod, {0, 0, z(n * kPeriod)}, true);
  }
  return oscillation;
}

TEST(Oscillation, HasTheAmplitudeAndFrequencyOfASine) {
  const Oscillation o = watched([](double t) { return 1e-3 * std::sin(2 * pi * 40 * t); });
  ASSERT_TRUE(o.cycle().has_value());
  EXPECT_NEAR(o.cycle()->amplitude_m, 1e-3, 1e-5);
  EXPECT_NEAR(o.cycle()->frequency_hz, 40, 2);
}

TEST(Rest, OfADeviceThatFliesAwayIsNone) {
  const RestWatch watch = rest([](double t) { return 0.1 * t; });
  EXPECT_FALSE(watch.cycle().has_value());
  EXPECT_EQ(watch.verdict(), Verdict::moves_on);
  ASSERT_TRUE(watch.moves_on().has_value());
  EXPECT_NEAR(*watch.moves_on(), 0.1, 1e-3);
}

// A tremble that nobody feels does not make a cycle of a drift.
TEST(Rest, CountsNoTurnsThatNobodyFeels) {
  const RestWatch watch =
      rest([](double t) { return 1e-3 * t + 0.4 * Oscillation::kFelt * std::sin(1e3 * t); });
  EXPECT_EQ(watch.verdict(), Verdict::moves_on);
}

TEST(Rest, OfADeviceThatSettlesIsOne) {
  const RestWatch watch =
      rest([](double t) { return 1e-3 * std::exp(-9 * t) * std::sin(2 * pi * 40 * t); });
  EXPECT_TRUE(watch.compared());
  EXPECT_EQ(watch.verdict(), Verdict::comes_to_rest);
}

// At any frequency that the rest is long enough for; else it is not known, and is no rest.
TEST(Rest, ASwingIsKnownByItsSize) {
  for (const double frequency : {0.8, 1.5, 2.5, 4.0, 6.0, 9.0, 25.0, 60.0}) {
    const auto swing = [&](double t) { return 2e-3 * std::sin(2 * pi * frequency * t + 0.3); };
    for (const double seconds : {0.6, 1.0, 1.5, 2.5, 4.0}) {
      const Verdict verdict = rest(swing, seconds).verdict();
      EXPECT_NE(verdict, Verdict::comes_to_rest) << frequency << " Hz, " << seconds << " s";
      if (seconds * frequency >= 8) {
        EXPECT_EQ(verdict, Verdict::swings) << frequency << " Hz, " << seconds << " s";
      }
    }
    const auto decays = [&](double t) { return std::exp(-3 * t) * swing(t); };
    EXPECT_EQ(rest(decays, 4).verdict(), Verdict::comes_to_rest) << frequency;
  }
}

// It gets smaller by a tenth and more at first, and then lasts.
TEST(Rest, ASwingThatIsApproachedFromAboveIsNone) {
  const auto swing = [](double t) {
    return 1e-3 * (1 + 0.3 * std::exp(-2 * t)) * std::sin(2 * pi * 20 * t);
  };
  for (const double seconds : {0.6, 1.0, 1.4, 2.0}) {
    EXPECT_NE(rest(swing, seconds).verdict(), Verdict::comes_to_rest) << seconds;
  }
}

// However the windows lie: what moved last counts, and what was before it does not.
TEST(Rest, LooksAtTheVeryEnd) {
  const auto late = [](double t) { return t < 0.9 ? 0.01 : 0.01 + 1e-3 * (t - 0.9) / 0.1; };
  EXPECT_NE(rest(late, 1).verdict(), Verdict::comes_to_rest);
  const auto early = [](double t) { return t < 0.3 ? 0.01 * t : 0.003; };
  const RestWatch watch = rest(early, 0.9);
  EXPECT_EQ(watch.verdict(), Verdict::comes_to_rest);
  EXPECT_LE(*watch.last_moves_m(), RestWatch::kStill);
}

// What still moved by 20 mm in the last window did not come to rest, however much it slowed down.
TEST(Rest, ACreepThatIsNotOverIsNotMeasured) {
  const auto creep = [](double t) { return 0.1 * std::exp(-t); };
  const RestWatch watch = rest(creep, 1);
  EXPECT_EQ(watch.verdict(), Verdict::not_measured);
  EXPECT_NEAR(*watch.last_moves_m(), creep(0.5) - creep(1.0), 1e-3) << "to the very end";
  EXPECT_EQ(rest(creep, 9).verdict(), Verdict::comes_to_rest);
}

TEST(Rest, TooShortSaysNothing) {
  const RestWatch watch = rest([](double) { return 0.0; }, 0.4);
  EXPECT_FALSE(watch.compared());
  EXPECT_EQ(watch.verdict(), Verdict::not_measured);
}

// The worst of the rests that were long enough says of the run: a calm end takes nothing back.
TEST(Rest, OfSeveralIsTheWorst) {
  RestWatch watch;
  auto phase = [&, n = 0](double seconds, bool rests, auto z) mutable {
    for (int i = 0; i < seconds / kPeriod; ++i, ++n) {
      watch.add(n, n * kPeriod, {0, 0, z(i * kPeriod)}, rests);
    }
  };
  const auto still = [](double) { return 0.01; };
  phase(1, true, still);
  EXPECT_EQ(watch.verdict(), Verdict::comes_to_rest);
  phase(0.2, false, still);
  phase(0.3, true, [](double t) { return 0.1 * t; });
  EXPECT_EQ(watch.verdict(), Verdict::comes_to_rest) << "too short a rest says nothing";
  phase(0.2, false, still);
  phase(1, true, [](double t) { return 0.1 * std::exp(-t); });
  EXPECT_EQ(watch.verdict(), Verdict::not_measured);
  phase(0.2, false, still);
  phase(1, true, still);
  EXPECT_EQ(watch.verdict(), Verdict::not_measured);
  EXPECT_GT(*watch.last_moves_m(), 1e-3) << "of the rest that was none";
  phase(0.2, false, still);
  phase(1, true, [](double t) { return 0.1 * t; });
  EXPECT_EQ(watch.verdict(), Verdict::moves_on);
  phase(0.2, false, still);
  phase(1, true, [](double t) { return 1e-3 * std::sin(2 * pi * 20 * t); });
  phase(0.2, false, still);
  phase(1, true, still);
  EXPECT_EQ(watch.verdict(), Verdict::swings);
}

// However long a run goes on, with whatever it loses by then.
TEST(LoopEnergy, DoesNotForgetThatTheLoopWasActive) {
  LoopEnergy loop;
  PlantState plant;
  loop.add({}, plant);
  plant.energy.by_motors = plant.energy.kinetic = 1e-4;
  loop.add({}, plant);
  EXPECT_TRUE(loop.active());
  plant.energy.by_intention = plant.energy.device_damping = 10;
  loop.add({}, plant);
  EXPECT_TRUE(loop.active());
  EXPECT_DOUBLE_EQ(loop.least_at_port(), -1e-4);
}

TEST(LoopQuality, SaysThatTheTipIsOutOfReach) {
  LoopQuality quality;
  LoopSample sample;
  quality.add(sample);
  EXPECT_FALSE(quality.flags().has(stability::Flag::device_at_its_limit));
  sample.unreachable = true;
  quality.add(sample);
  EXPECT_TRUE(quality.flags().has(stability::Flag::device_at_its_limit));
  EXPECT_EQ(quality.limit_frames(), 1);
}

}  // namespace
}  // namespace hvp::plant::oscillation_test
