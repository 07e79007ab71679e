#include <nlohmann/json.hpp>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// What a verdict is called: never more than what was measured.
namespace hvp::cli::verdict_test {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

struct Judged {
  Ended ended;
  json summary;
};

// Of one of the project's scenarios, or of kSmallScene.
Judged judged(const std::string& name, const std::vector<std::string>& sets) {
  const ScratchDirectory place;
  if (name.empty()) write(place.path() / "s.toml", kSmallScene);
  std::vector<std::string> arguments = {"run",   name.empty() ? "s.toml" : scenario(name).string(),
                                        "--out", "out",
                                        "--set", "output.pictures=false",
                                        "--set", "output.remedies=false"};
  for (const std::string& set : sets) {
    arguments.emplace_back("--set");
    arguments.push_back(set);
  }
  Judged j;
  j.ended = hvp(place.path(), arguments);
  EXPECT_LT(j.ended.status, 2) << j.ended.err;
  j.summary = json::parse(read(place.path() / "out/summary.json"));
  return j;
}

json flags(const Judged& j) { return j.summary.at("stability").at("flags"); }

// A few contacts, true and rounded, tell at set-up what a reference would find: 37 % off here, and
// 93 % under gravity.
TEST(Verdict, WithoutAReferenceRoundingIsSeenAllTheSame) {
  for (const char* more : {"frames=300", "loads.gravity=true", "dynamics.mass=consistent"}) {
    const Judged j = judged("thesis.toml", {"reference=false", "frames=300", more});
    EXPECT_THAT(flags(j), Contains("matrix-rounding")) << more;
    EXPECT_THAT(j.ended.out, Not(HasSubstr("PASS"))) << more;
    EXPECT_FALSE(j.summary.at("accuracy").at("measured")) << more;
    EXPECT_GT(j.summary.at("accuracy").at("rounding").at("displacement_rel"), 0.06) << more;
  }
}

// The static body beside an anchor.
TEST(Verdict, RoundingBesideAnAnchorIsSeenWithoutAReference) {
  const Judged j =
      judged("thesis-static.toml",
             {"reference=false", "frames=300", "probe.start=[\"52 mm\", \"0 mm\", \"-20 mm\"]",
              "probe.motion=[{phase=\"press\", to=[\"40 mm\", \"0 mm\", \"-20 mm\"], "
              "duration=\"400 ms\"}]"});
  EXPECT_THAT(flags(j), Contains("matrix-rounding"));
}

TEST(Verdict, WithoutAReferenceAccuracyIsNotMeasured) {
  const Judged j = judged("", {"reference=false"});
  EXPECT_EQ(j.summary.at("verdict"), "held; accuracy not measured");
  EXPECT_THAT(j.ended.out, HasSubstr("force in time  held; accuracy not measured: worst"));
  EXPECT_THAT(j.ended.out, Not(HasSubstr("PASS")));
  EXPECT_EQ(j.ended.status, 0);
  const Judged measured = judged("", {});
  EXPECT_EQ(measured.summary.at("verdict"), "PASS");
  // What is not measured is not told from what is.
  EXPECT_LT(
      measured.summary.at("accuracy").at("displacement_of_frame").at("median"),
      2 * j.summary.at("accuracy").at("rounding").at("displacement_rel").get<double>() + 0.02);
}

// Frames of their own size first; the mean over all of the run's largest beside them.
TEST(Verdict, AccuracyIsOfAFramesOwnSizeFirst) {
  const json a = judged("thesis-static.toml", {"frames=1000"}).summary.at("accuracy");
  const json& own = a.at("displacement_of_frame");
  EXPECT_GT(own.at("median"), 1.5 * a.at("displacement_rel").get<double>());
  EXPECT_LE(own.at("median"), own.at("p95"));
  EXPECT_LE(own.at("p95"), own.at("worst"));
  EXPECT_LT(own.at("frames"), a.at("frames"));  // those in contact
}

// The graphics process finds a touch up to a pass late, and a body with mass swings from it.
TEST(Verdict, AContactThatIsFoundLateIsNoFaultOfTheSolver) {
  const std::vector<std::string> late = {"contact.kind=proxy", "dynamics=true",
                                         "probe.start=[\"1 mm\", \"1 mm\", \"10.01 mm\"]"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), late.begin(), late.end());
    return flags(judged("", more));
  };
  const json exact = with({"host.solver=cholesky"});
  EXPECT_THAT(exact, Contains("contact-missed"));
  EXPECT_THAT(exact, Not(Contains("matrix-rounding")));
  EXPECT_THAT(exact, Not(Contains("not-converged")));
  EXPECT_THAT(with({"host.solver=cholesky", "contact.fresh=true"}),
              Not(Contains("contact-missed")));
  // A host that iterates may stop too early, and is told so.
  EXPECT_THAT(with({"host.solver=cg", "solver.iterations=2", "contact.fresh=true"}),
              Contains("not-converged"));
}

TEST(Verdict, AProbeThatTouchesNothingIsNoPass) {
  const Judged j = judged("", {"probe.start=[\"1 mm\", \"1 mm\", \"14 mm\"]",
                               "probe.motion=[{phase=\"approach\", to=[\"1 mm\", \"1 mm\", "
                               "\"12 mm\"], duration=\"60 ms\"}]"});
  EXPECT_EQ(j.summary.at("verdict"), "held; no contact");
  EXPECT_THAT(j.ended.out, HasSubstr("no contact     the probe did not touch the body"));
  EXPECT_THAT(j.ended.out, HasSubstr("the body     x -10 mm to 10 mm"));
  // The tip comes to 12 mm, the body reaches 10.
  EXPECT_THAT(j.ended.out, HasSubstr("nearest      2 mm from the surface"));
  EXPECT_THAT(j.ended.out, Not(HasSubstr("unit")));
  EXPECT_THAT(j.ended.out, Not(HasSubstr("PASS")));
}

// Metres read as millimetres.
TEST(Verdict, SizesThatLookLikeAnotherUnitAreSaid) {
  const Judged j = judged(
      "", {"object.mesh.size=[\"20 um\", \"20 um\", \"20 um\"]", "solver.displacement_range=1 mm"});
  EXPECT_EQ(j.summary.at("verdict"), "held; no contact");
  EXPECT_THAT(j.ended.out, HasSubstr("unit"));
}

// A table that compares nothing measures nothing.
TEST(Verdict, AReferenceThatComparesNoContactIsNoMeasurement) {
  for (const char* every : {"900", "100000"}) {
    const Judged j = judged("thesis-static.toml",
                            {std::string("reference.every_frames=") + every, "frames=1000"});
    EXPECT_THAT(j.ended.out, Not(HasSubstr("PASS"))) << every;
    EXPECT_THAT(flags(j), Contains("matrix-rounding")) << every;
  }
  EXPECT_EQ(judged("", {"reference.every_frames=1000"}).summary.at("verdict"),
            "held; accuracy not measured");
}

// From below, onto the cap that is held: nothing follows the tip there, and nothing is dragged to
// it.
TEST(Verdict, AProbeOnAHeldPartHoldsNothingAndIsFlagged) {
  const Judged j = judged("thesis-static.toml",
                          {"frames=400", "probe.start=[\"0 mm\", \"0 mm\", \"-60 mm\"]",
                           "probe.motion=[{phase=\"press\", to=[\"0 mm\", \"0 mm\", \"-45 mm\"], "
                           "duration=\"400 ms\"}]"});
  EXPECT_THAT(flags(j), Contains("contact-missed"));
  EXPECT_EQ(j.summary.at("contact").at("changes"), 0);
  EXPECT_LT(j.summary.at("missed_contact").at("m"), -2e-3);
  EXPECT_THAT(j.ended.out, HasSubstr("inside the body: no force"));
  EXPECT_THAT(j.ended.out, Not(HasSubstr("PASS")));
}

// Between two passes of a slow collision process.
TEST(Verdict, AContactThatNoPassSawIsFlagged) {
  const Judged j =
      judged("thesis-static.toml", {"reference=false", "frames=500", "host.graphics.rate=1 Hz",
                                    "host.graphics.drawing_time=0 s"});
  EXPECT_THAT(flags(j), Contains("contact-missed"));
  EXPECT_EQ(j.summary.at("contact").at("changes"), 0);
}

TEST(Verdict, SizesAreSaidWithAContactToo) {
  const Judged j =
      judged("thesis-static.toml", {"reference=false", "frames=300", "object.mesh.radius=50 m"});
  EXPECT_THAT(j.ended.out, HasSubstr("check the units"));
}

TEST(ErrorBudget, DecidesTheExitStatus) {
  const Judged free = judged("", {});
  const double p95 =
      free.summary.at("accuracy").at("displacement_of_frame").at("p95").get<double>();
  const double worst = free.summary.at("accuracy").at("displacement_worst_rel").get<double>();
  const double least = std::max(p95, worst);
  const auto budget = [](double limit) {
    return "budget.displacement_error=" + std::to_string(limit);
  };
  const Judged held = judged("", {budget(1.01 * least)});
  EXPECT_EQ(held.ended.status, 0);
  EXPECT_TRUE(held.summary.at("error_budget").at("displacement").at("held"));
  const Judged missed = judged("", {budget(0.99 * least)});
  EXPECT_EQ(missed.ended.status, 1);
  EXPECT_FALSE(missed.summary.at("error_budget").at("displacement").at("held"));
  EXPECT_FALSE(missed.summary.at("held"));
  EXPECT_EQ(missed.summary.at("verdict"), "not held");
  EXPECT_EQ(judged("", {"budget.force_error=1e-9"}).ended.status, 1);
  EXPECT_EQ(judged("", {"budget.force_error=9"}).ended.status, 0);
}

TEST(ErrorBudget, NeedsAReference) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", kSmallScene);
  const Ended ended = hvp(place.path(), {"run", "s.toml", "--set", "reference=false", "--set",
                                         "budget.force_error=0.1"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, HasSubstr("budget.force_error"));
  EXPECT_THAT(ended.err, HasSubstr("[reference]"));
}

}  // namespace
}  // namespace hvp::cli::verdict_test
