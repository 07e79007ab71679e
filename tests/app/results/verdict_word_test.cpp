#include <functional>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/results/outcome.h"

// Every figure that a verdict uses moves it: of a run that is a PASS one is changed at a time.
namespace hvp::results::verdict_word_test {
namespace {

constexpr double kPeriod = 1e-3;

// A device that rests for a second, or does what `z` says of the time.
plant::LoopQuality device(const std::function<double(double)>& z, double seconds = 1) {
  plant::LoopQuality quality;
  for (int n = 0; n < seconds / kPeriod; ++n) {
    plant::LoopSample sample;
    sample.frame = n;
    sample.time_s = n * kPeriod;
    sample.plant.tip.position = {0, 0, z(sample.time_s)};
    sample.rests = true;
    quality.add(sample);
  }
  return quality;
}

// A frame that is whole, a picosecond within or beyond its budget.
vp::Verdict verdict_of(vp::Picoseconds latency) {
  vp::Verdict verdict(2'000'000, 1'000'000);
  vp::Frame frame;
  frame.spans = {{vp::Part::host, vp::Phase::force, 0, latency, vp::kBirth}};
  frame.force_at_motor = 0;
  frame.work_done = latency;
  vp::CriticalPath path;
  path.follow(frame);
  verdict.closed(frame, path);
  return verdict;
}

Accuracy accuracy(std::int64_t compared, std::int64_t in_contact) {
  Accuracy a;
  a.displacement.of_frame = host::Deviation::OfFrame{.frames = compared};
  a.compared = compared;
  a.in_contact = in_contact;
  a.frames = compared;
  return a;
}

StiffnessBudget stiffness(double edge_N_m, double contact_N_m) {
  StiffnessBudget budget;
  budget.moving = true;
  budget.edge_N_m = edge_N_m;
  budget.contact_N_m = contact_N_m;
  return budget;
}

Outcome passing() {
  Outcome o;
  o.scene.frames = 1;
  o.scene.body = BodyFigures{};
  o.ticks = 1;
  o.contact.changes = 1;
  o.loop = {device([](double) { return 0.0; })};
  o.stiffness = stiffness(2000, 1000);
  o.accuracy = accuracy(20, 100);
  return o;
}

struct Change {
  const char* name;
  std::function<void(Outcome&)> apply;
  std::string_view word;
};

TEST(VerdictWord, IsMovedByEveryFigureThatItUses) {
  ASSERT_EQ(passing().verdict_word(), "PASS");
  const std::vector<Change> changes = {
      {"interrupted", [](Outcome& o) { o.scene.frames = 2; }, "held so far"},
      {"a flag", [](Outcome& o) { o.flags.raise(stability::Flag::low_gain_margin); },
       "held, with flags"},
      {"a fault", [](Outcome& o) { o.faults.emplace_back().injected = 1; }, "held, with faults"},
      {"a wrong solution", [](Outcome& o) { o.faults.emplace_back().effect.wrong = 1; },
       "held, with wrong solutions"},
      {"the driver's error", [](Outcome& o) { o.servo.errors.front().count = 1; },
       "held, with faults"},
      {"a lost interrupt", [](Outcome& o) { o.servo.mended.lost_interrupts = 1; },
       "held, with faults"},
      {"times only", [](Outcome& o) { o.scene.timing_only = true; }, "PASS, timing only"},
      {"no contact", [](Outcome& o) { o.contact.changes = 0; }, "held; no contact"},
      {"a wall without a loop",
       [](Outcome& o) {
         o.scene.body.reset();
         o.loop.clear();
       },
       "held; loop not closed"},
      {"a second device that flies away",
       [](Outcome& o) { o.loop.push_back(device([](double t) { return 0.1 * t; })); },
       "held; a device moves on"},
      {"a second device that never rests",
       [](Outcome& o) { o.loop.push_back(device([](double) { return 0.0; }, 0.3)); },
       "held; coming to rest not measured"},
      {"nothing moved in contact", [](Outcome& o) { o.stiffness->moving = false; },
       "held; gain margin not measured"},
      {"a contact of unknown stiffness", [](Outcome& o) { o.stiffness->contact_N_m.reset(); },
       "held; gain margin not measured"},
      {"no budget of stiffness", [](Outcome& o) { o.stiffness.reset(); },
       "held; gain margin not measured"},
      {"no reference", [](Outcome& o) { o.accuracy.reset(); }, "held; accuracy not measured"},
      {"a few frames compared", [](Outcome& o) { o.accuracy = accuracy(19, 100); },
       "held; accuracy not measured"},
  };
  for (const Change& change : changes) {
    Outcome o = passing();
    change.apply(o);
    EXPECT_EQ(o.verdict_word(), change.word) << change.name;
  }
  // Few frames are enough where there are no more.
  Outcome o = passing();
  o.accuracy = accuracy(3, 3);
  EXPECT_EQ(o.verdict_word(), "PASS");
}

TEST(Held, IsMovedByEveryBudget) {
  const auto held = [](const std::function<void(Outcome&)>& change) {
    Outcome o = passing();
    o.verdict = verdict_of(1'000'000);
    change(o);
    return o.held();
  };
  EXPECT_TRUE(held([](Outcome&) {}));
  EXPECT_FALSE(held([](Outcome& o) { o.verdict = verdict_of(1'000'001); }));
  EXPECT_FALSE(held([](Outcome& o) { o.verdict.skip_tick(); }));
  EXPECT_FALSE(held([](Outcome& o) { o.servo.driver_errors = 1; }));
  const ErrorBudget within{
      .of = "force", .limit = 0.02, .p95 = 0.02, .worst = 0.02, .measured = true};
  const auto with = [&](auto change) {
    return held([&](Outcome& o) {
      ErrorBudget budget = within;
      change(budget);
      o.error_budgets = {within, budget};
    });
  };
  EXPECT_TRUE(with([](ErrorBudget&) {}));
  EXPECT_FALSE(with([](ErrorBudget& b) { b.p95 = 0.0201; }));
  EXPECT_FALSE(with([](ErrorBudget& b) { b.worst = 0.0201; }));
  EXPECT_FALSE(with([](ErrorBudget& b) { b.measured = false; }));
}

TEST(Margin, BelowWhatIsStatedIsFlagged) {
  const auto flagged = [](double edge, double contact, double least) {
    return margin_flags(stiffness(edge, contact), least).has(stability::Flag::low_gain_margin);
  };
  EXPECT_FALSE(flagged(1000, 1000, 1));
  EXPECT_TRUE(flagged(999.9, 1000, 1));
  EXPECT_TRUE(flagged(1999, 1000, 2));
  EXPECT_FALSE(flagged(2000, 1000, 2));
  EXPECT_TRUE(margin_flags(std::nullopt, 2).empty());
}

}  // namespace
}  // namespace hvp::results::verdict_word_test
