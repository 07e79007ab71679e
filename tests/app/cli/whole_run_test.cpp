#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// A verdict speaks for the whole run: files that once got one which did not, each with what is
// right (tests/data/cases/).
namespace hvp::cli::whole_run_test {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

const std::filesystem::path kCases = std::filesystem::path(HVP_TEST_DATA) / "cases";

// A case's file beside which its data lie, with its base where the project has it.
void place_case(const std::filesystem::path& folder, const std::string& name) {
  std::string text = read(kCases / name);
  const std::size_t at = text.find("base = \"");
  if (at != std::string::npos) {
    const std::size_t begin = at + 8;
    const std::size_t end = text.find('"', begin);
    text.replace(begin, end - begin, scenario(text.substr(begin, end - begin)).string());
  }
  write(folder / "case.toml", text);
}

struct Result {
  Ended ended;
  json summary;
  std::string frames;  // frames.csv

  std::string verdict() const { return summary.at("verdict"); }
  std::vector<std::string> flags() const { return summary.at("stability").at("flags"); }
};

Result run_case(const std::string& name, const std::vector<std::string>& changes = {},
                const std::string& beside = {}) {
  const ScratchDirectory place;
  place_case(place.path(), name);
  if (!beside.empty()) {
    write(place.path() / std::filesystem::path(beside).filename(), read(kCases / beside));
  }
  std::vector<std::string> arguments = {
      "run", "case.toml", "--out", "out", "--quiet", "--set", "output.pictures=false"};
  for (const std::string& change : changes) {
    arguments.emplace_back("--set");
    arguments.push_back(change);
  }
  Result result;
  result.ended = hvp(place.path(), arguments);
  EXPECT_LT(result.ended.status, 2) << result.ended.err;
  result.summary = json::parse(read(place.path() / "out/summary.json"));
  result.frames = read(place.path() / "out/frames.csv");
  return result;
}

const std::vector<std::string> kNoRemedies = {"output.remedies=false"};

// The columns of a table by their names.
std::map<std::string, std::vector<double>> columns_of(const std::string& csv) {
  std::map<std::string, std::vector<double>> columns;
  std::vector<std::string> names;
  for (const std::string& line : lines(csv)) {
    std::istringstream fields(line);
    std::size_t at = 0;
    const bool header = names.empty();
    for (std::string field; std::getline(fields, field, ',');) {
      if (header) {
        names.push_back(field);
      } else {
        columns[names.at(at++)].push_back(std::strtod(field.c_str(), nullptr));
      }
    }
  }
  return columns;
}

TEST(WholeRun, StrainIsThatOfTheDeepestFrame) {
  const Result early = run_case("tap-between-looks/early.toml", kNoRemedies);
  const Result late = run_case("tap-between-looks/late.toml", kNoRemedies);
  for (const Result* result : {&early, &late}) {
    EXPECT_THAT(result->flags(), Contains("beyond-linearity"));
    EXPECT_NEAR(result->summary.at("strain").at("largest").get<double>(), 1.51, 0.01);
    EXPECT_EQ(result->summary.at("strain").at("inverted_elements"), 1);
  }
  EXPECT_NEAR(early.summary["strain"]["largest"].get<double>(),
              late.summary["strain"]["largest"].get<double>(), 1e-3);
}

// Two frames of 173 say nothing of 95 % of them.
TEST(WholeRun, ABudgetOnMostFramesIsNotMeasuredByAFew) {
  const ScratchDirectory place;
  const auto run = [&](const std::string& every) {
    const Ended ended =
        hvp(place.path(),
            {"run", scenario("thesis-static.toml").string(), "--out", "out", "--quiet", "--set",
             "frames=330", "--set", "output.pictures=false", "--set", "output.remedies=false",
             "--set", "budget.force_error=0.02", "--set", "reference.every_frames=" + every});
    return std::pair(ended, json::parse(read(place.path() / "out/summary.json")));
  };
  const auto [every, of_every] = run("1");
  EXPECT_EQ(every.status, 1);
  EXPECT_THAT(every.out, HasSubstr("force error    EXCEEDED: 95 % of 173 frames within"));
  const auto [sparse, of_sparse] = run("97");
  EXPECT_EQ(sparse.status, 1);
  EXPECT_THAT(sparse.out, HasSubstr("NOT MEASURED: 2 of 173 frames in contact compared"));
  const json& budget = of_sparse["error_budget"]["force"];
  EXPECT_EQ(budget["compared"], 2);
  EXPECT_EQ(budget["in_contact"], 173);
  EXPECT_TRUE(budget["p95_rel"].is_null());
  const auto [some, of_some] = run("8");
  EXPECT_THAT(some.out, HasSubstr("22 frames compared of 173 in contact within"));
}

// A body at rest skips its solve; that makes no moving loop any stiffer.
TEST(WholeRun, TheStiffnessBudgetIsOfFramesThatMove) {
  std::vector<std::string> changes = kNoRemedies;
  const Result result = run_case("loop/budget-shrinks-at-rest.toml", changes);
  const json& stiffness = result.summary.at("stiffness");
  EXPECT_NEAR(stiffness["delay_us"].get<double>(), 1089, 3);
  EXPECT_NEAR(stiffness["stable_N_m"].get<double>(), 2725, 6);
  EXPECT_NEAR(stiffness["passive_N_m"].get<double>(), 479, 1);
  EXPECT_GE(stiffness["worst_delay_us"], stiffness["delay_us"]);
  // The edge is that of the worst of them, which is later than the mean.
  EXPECT_NEAR(stiffness["worst_delay_us"].get<double>(), 1093.6, 1);
  EXPECT_NEAR(stiffness["edge_N_m"].get<double>(), 2719, 2);
  changes.emplace_back("frames=2400");
  const Result longer = run_case("loop/budget-shrinks-at-rest.toml", changes);
  EXPECT_EQ(longer.summary["stiffness"]["margin"], stiffness["margin"]);
  EXPECT_NEAR(longer.summary["stiffness"]["stable_N_m"].get<double>(),
              stiffness["stable_N_m"].get<double>(), 3);
}

TEST(WholeRun, IsNoPassBeyondTheEdgeThatItReports) {
  const Result result = run_case("loop/pass-beyond-own-limit.toml");
  EXPECT_NEAR(result.summary["stiffness"]["margin"].get<double>(), 5610.0 / 10000, 1e-3);
  EXPECT_THAT(result.flags(), Contains("low-gain-margin"));
  EXPECT_EQ(result.verdict(), "held, with flags");
  EXPECT_THAT(result.ended.out, HasSubstr("beyond the edge of the linear loop"));
  // Within the edge, and within twice of it.
  const std::vector<std::string> softer = {"wall.stiffness=5000 N/m"};
  EXPECT_THAT(run_case("loop/pass-beyond-own-limit.toml", softer).flags(),
              Not(Contains("low-gain-margin")));
  const std::vector<std::string> stated = {"wall.stiffness=5000 N/m", "budget.gain_margin=2"};
  EXPECT_THAT(run_case("loop/pass-beyond-own-limit.toml", stated).flags(),
              Contains("low-gain-margin"));
}

// Before and after the hand lets go: 5610 N/m with it, 1003.3 without.
TEST(WholeRun, TheMarginIsThatWithoutAHandThatLetsGo) {
  const ScratchDirectory place;
  const auto margin = [&](const std::string& lets_go) {
    hvp(place.path(), {"run", scenario("wall-in-hand.toml").string(), "--out", "out", "--quiet",
                       "--set", "output.pictures=false", "--set", "output.remedies=false", "--set",
                       "wall.stiffness=1050 N/m", "--set", "hand.lets_go=" + lets_go});
    return json::parse(read(place.path() / "out/summary.json"))["stiffness"]["margin"]
        .get<double>();
  };
  EXPECT_NEAR(margin("0 s"), 5610.0 / 1050, 0.01);
  EXPECT_NEAR(margin("1.5 s"), 1003.3 / 1050, 0.001);
  EXPECT_NEAR(margin("100 s"), 5610.0 / 1050, 0.01) << "after the run";
}

// A swing of 3.5 mm at 4 Hz has few turns in a quarter of a second, and is none the less no rest.
TEST(WholeRun, ASlowSwingIsNoRest) {
  const Result result = run_case("loop/slow-swing-passes.toml", kNoRemedies);
  EXPECT_NE(result.verdict(), "PASS");
  EXPECT_FALSE(result.summary["loop"][0]["oscillation_measured"]);
  // What is said of the end is what the positions of its last quarter to half of a second show.
  const auto columns = columns_of(result.frames);
  const auto moves = [&](std::ptrdiff_t frames) {
    double most_of_axes = 0;
    for (const char* axis : {"tip_x_m", "tip_y_m", "tip_z_m"}) {
      const std::vector<double>& tip = columns.at(axis);
      const auto [least, most] = std::minmax_element(tip.end() - frames, tip.end());
      most_of_axes = std::max(most_of_axes, *most - *least);
    }
    return most_of_axes;
  };
  const double said = result.summary["loop"][0]["last_moves_m"];
  EXPECT_GE(said, moves(25) * (1 - 1e-9));
  EXPECT_LE(said, moves(66) * (1 + 1e-9)) << "two windows of 33 frames of 10 ms";
  EXPECT_GT(said, 3e-3);
  EXPECT_THAT(result.ended.out, HasSubstr("not measured: still moves by "));
  // Where the run is long enough, it is known for what it is.
  const Result longer =
      run_case("loop/slow-swing-passes.toml", {"output.remedies=false", "frames=1000"});
  EXPECT_THAT(longer.flags(), Contains("limit-cycle"));
  EXPECT_NEAR(longer.summary["loop"][0]["oscillation"]["frequency_hz"].get<double>(), 4, 2)
      << "by turns of half a second";
}

// The converter's nearest step to a clamped force may lie beyond the limit.
TEST(WholeRun, TheMotorsNeverGiveMoreThanTheMakersLimit) {
  const Result result = run_case("loop/dac-beyond-limit.toml", kNoRemedies);
  const auto columns = columns_of(result.frames);
  const auto& x = columns.at("motor_x_N");
  const auto& y = columns.at("motor_y_N");
  const auto& z = columns.at("motor_z_N");
  for (std::size_t i = 0; i < x.size(); ++i) {
    ASSERT_LE(std::hypot(x[i], y[i], z[i]), 0.5 * (1 + 1e-9)) << i;
  }
  EXPECT_GT(*std::ranges::max_element(columns.at("force_N")), 0.5);
  EXPECT_THAT(result.flags(), Contains("force-saturated"));
}

struct Edge {
  std::string scenario;
  std::vector<std::string> changes;
  double stiffness = 0;  // N/m, by eigenvalues, and by 8000 frames of the first
};

// Runs search the edge for as long as the loop's slowest swing takes.
TEST(WholeRun, StabilityIsThatOfTheEigenvaluesAtAnyPeriod) {
  const ScratchDirectory place;
  const auto stability = [&](const std::string& name, const std::vector<std::string>& changes) {
    place_case(place.path(), name);
    std::vector<std::string> arguments = {"stability", "case.toml", "--json", "--quiet"};
    for (const std::string& change : changes) {
      arguments.emplace_back("--set");
      arguments.push_back(change);
    }
    return json::parse(hvp(place.path(), arguments).out);
  };
  const std::string slow = "loop/stability-unstable-below-passive.toml";
  for (const Edge& edge : {Edge{"loop/stability-2khz.toml", {}, 4000}, Edge{slow, {}, 184.66}}) {
    const json found = stability(edge.scenario, edge.changes);
    EXPECT_NEAR(found["stiffness_max"].get<double>(), edge.stiffness, 0.02 * edge.stiffness);
    EXPECT_NEAR(found["stiffness_linear"].get<double>(), edge.stiffness, 2e-4 * edge.stiffness);
    EXPECT_GE(found["unstable_from"], found["stiffness_passive"]);
  }
  // Far more than 64 periods late: said to be not computed, rather than none.
  const json late = stability(slow, {"host.delay.time=100 ms"});
  EXPECT_FALSE(late["linear_computed"]);
  EXPECT_TRUE(late["stiffness_linear"].is_null());
}

// What registers leave of a swing that is gone is no instability, friction that holds the device is
// no stability, and neither is a swing that grows to twice its start.
TEST(WholeRun, StabilityIsOfASwingThatIsThere) {
  const ScratchDirectory place;
  const auto found = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"stability", scenario("wall.toml").string(), "--json",
                                          "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return json::parse(hvp(place.path(), arguments).out);
  };
  const json rounded =
      found({"--set", "budget.period=33 ms", "--set", "host.delay.time=5.3 ms", "--set",
             "device.dynamics.mass=10.65 g", "--set", "device.dynamics.damping=9.2083 N s/m",
             "--set", "hand.model=custom", "--set", "hand.stiffness=22.37 N/m", "--set",
             "hand.damping=8.238 N s/m", "--set", "wall.damping=13.86 N s/m"});
  EXPECT_NEAR(rounded["stiffness_linear"].get<double>(), 790.8, 0.1);
  EXPECT_NEAR(rounded["stiffness_max"].get<double>(), 790.8, 0.02 * 790.8);
  const json none =
      found({"--set", "budget.period=1.03 ms", "--set", "host.delay.time=5.3 ms", "--set",
             "device.dynamics.mass=15.364 g", "--set", "device.dynamics.damping=13.778 N s/m",
             "--set", "wall.damping=26.112 N s/m"});
  EXPECT_TRUE(none["stiffness_linear"].is_null());
  EXPECT_TRUE(none["stiffness_max"].is_null()) << none["stiffness_max"];
  const json stuck = found({"--set", "device.model=touch", "--set", "device.dynamics.mass=45 g",
                            "--set", "host.delay.time=0.9 ms", "--push", "0.1"});
  EXPECT_TRUE(stuck["stuck"]);
  EXPECT_FALSE(rounded["stuck"]);
}

// A force limit keeps the swing from growing, not from going on.
TEST(WholeRun, ASwingThatIsClampedIsNotStable) {
  const ScratchDirectory place;
  const auto edge = [&](const std::vector<std::string>& changes) {
    std::vector<std::string> arguments = {"stability", scenario("wall.toml").string(),
                                          "--json",    "--quiet",
                                          "--push",    "8",
                                          "--set",     "device.dynamics.mass=75 g",
                                          "--set",     "host.delay.time=1.03 ms"};
    for (const std::string& change : changes) {
      arguments.emplace_back("--set");
      arguments.push_back(change);
    }
    return json::parse(hvp(place.path(), arguments).out)["stiffness_max"].get<double>();
  };
  const double free = edge({});
  const double limited = edge({"device.limits.force=8.5 N"});
  EXPECT_LE(limited, 1.02 * free);
}

TEST(WholeRun, ARemedyIsRunAsPrintedAndSaysWhatStays) {
  const Result deep = run_case("remedy-no-flags/deep.toml");
  const json& remedy = deep.summary.at("remedy");
  EXPECT_TRUE(remedy.at("whole_run"));
  EXPECT_FALSE(remedy.at("works"));
  EXPECT_EQ(remedy.at("leaves"), json({"beyond-linearity", "contact-missed"}));
  EXPECT_THAT(deep.ended.out, HasSubstr("stays: beyond-linearity, contact-missed"));
  std::vector<std::string> as_printed = remedy.at("set");
  as_printed.emplace_back("output.remedies=false");
  EXPECT_EQ(json(run_case("remedy-no-flags/deep.toml", as_printed).flags()), remedy.at("leaves"));
  // Nothing is displaced in the frames of this one, and yet its words are what they are.
  const Result through = run_case("remedy-no-flags/through.toml");
  EXPECT_EQ(through.summary.at("remedy").at("leaves"), json({"contact-missed"}));
}

// A body in a closed loop has remedies too, for its words and for its loop.
TEST(WholeRun, ABodyInAClosedLoopHasARemedy) {
  const ScratchDirectory place;
  const auto run = [&](const std::string& name, std::vector<std::string> changes) {
    std::vector<std::string> arguments = {
        "run",   scenario(name).string(), "--out", "out", "--quiet",
        "--set", "output.pictures=false"};
    for (std::string& change : changes) {
      arguments.emplace_back("--set");
      arguments.push_back(std::move(change));
    }
    hvp(place.path(), arguments);
    return json::parse(read(place.path() / "out/summary.json"));
  };
  const json words = run("thesis-in-hand.toml", {});
  ASSERT_FALSE(words["remedy"].is_null());
  EXPECT_THAT(words["remedy"]["takes_away"].get<std::vector<std::string>>(),
              Contains("matrix-rounding"));
  const json stiff = run("sphere-in-hand.toml", {"budget.gain_margin=40"});
  ASSERT_THAT(stiff["stability"]["flags"].get<std::vector<std::string>>(),
              Contains("low-gain-margin"));
  ASSERT_FALSE(stiff["remedy"].is_null());
  EXPECT_TRUE(stiff["remedy"]["works"]) << stiff["remedy"];
}

// One meaning of a table of latencies, wherever it is read.
TEST(WholeRun, MeasuredLatenciesAreWeighedAndNotTakenForStamps) {
  const std::string folder = "histogram-as-samples/";
  for (const char* name : {"hist", "stamped"}) {
    const Result result =
        run_case(folder + name + ".toml", kNoRemedies, folder + name + std::string(".csv"));
    EXPECT_EQ(result.summary["deadline"]["misses"], 0) << name;
    // Two wake-ups of at most 6 us are on the way.
    EXPECT_LE(result.summary["jitter"]["wake_up"]["worst_us"].get<double>(), 12) << name;
  }
}

// Terminal, summary, frames and picture have one account of the energy.
TEST(WholeRun, TheObserverIsPassiveEverywhere) {
  const ScratchDirectory place;
  hvp(place.path(), {"run", scenario("wall.toml").string(), "--out", "out", "--quiet", "--set",
                     "output.pictures=false"});
  const json summary = json::parse(read(place.path() / "out/summary.json"));
  const auto columns = columns_of(read(place.path() / "out/frames.csv"));
  EXPECT_EQ(std::ranges::count(columns.at("fed_in"), 1), 0);
  EXPECT_GE(*std::ranges::min_element(columns.at("port_J")), -1e-6);
  EXPECT_NEAR(std::min(0.0, *std::ranges::min_element(columns.at("port_J"))),
              summary["loop"][0]["energy"]["port"]["least_J"].get<double>(), 1e-9);
}

// The user feels a force that nothing leads up to.
TEST(WholeRun, AProbeThatBeginsInAWallIsFlagged) {
  const ScratchDirectory place;
  const auto flags = [&](const std::string& start) {
    hvp(place.path(), {"run", scenario("wall-in-hand.toml").string(), "--out", "out", "--quiet",
                       "--set", "output.pictures=false", "--set", "output.remedies=false", "--set",
                       "probe.start=[\"0 mm\", \"0 mm\", \"" + start + " mm\"]"});
    return json::parse(read(place.path() / "out/summary.json"))["stability"]["flags"]
        .get<std::vector<std::string>>();
  };
  EXPECT_THAT(flags("-10"), Contains("force-step"));
  EXPECT_THAT(flags("10"), Not(Contains("force-step")));
}

// Of two probes the second is inside, and nothing holds it until a pass of the collision process.
TEST(WholeRun, AContactIsMissedByAnyProbe) {
  const ScratchDirectory place;
  hvp(place.path(), {"run", scenario("pinch.toml").string(), "--out", "out", "--quiet", "--set",
                     "output.pictures=false", "--set", "output.remedies=false", "--set",
                     "frames=30", "--set", "probe[1].start=[\"30 mm\", \"0 mm\", \"0 mm\"]"});
  const json summary = json::parse(read(place.path() / "out/summary.json"));
  EXPECT_THAT(summary["stability"]["flags"].get<std::vector<std::string>>(),
              Contains("contact-missed"));
  EXPECT_NEAR(summary["missed_contact"]["m"].get<double>(), -0.02, 1e-3);
}

// The body's contact is linear: twice its modulus is twice its stiffness and half the margin.
TEST(WholeRun, TheMarginGoesWithTheContactsStiffness) {
  const ScratchDirectory place;
  const auto stiffness = [&](const std::string& modulus) {
    hvp(place.path(), {"run", scenario("sphere-in-hand.toml").string(), "--out", "out", "--quiet",
                       "--set", "output.pictures=false", "--set", "output.remedies=false", "--set",
                       "frames=400", "--set", "object.material.young_modulus=" + modulus});
    return json::parse(read(place.path() / "out/summary.json"))["stiffness"];
  };
  const json soft = stiffness("10 kPa");
  const json stiff = stiffness("20 kPa");
  const double once = soft["contact_N_m"];
  EXPECT_NEAR(stiff["contact_N_m"].get<double>(), 2 * once, 1e-9 * once);
  EXPECT_NEAR(soft["margin"].get<double>() / stiff["margin"].get<double>(), 2, 0.01);
}

// An effect that the device's model has keeps the model's values when it is switched on.
TEST(WholeRun, SwitchingOnWhatTheModelHasChangesNothing) {
  const ScratchDirectory place;
  const Ended ended =
      hvp(place.path(), {"resolve", scenario("wall-in-hand.toml").string(), "--set",
                         "device.model=premium-1.5", "--set", "device.friction=true"});
  EXPECT_THAT(ended.out, HasSubstr("[device.friction]\nforce = \"40 mN\"")) << ended.err;
}

struct SurfaceCase {
  std::string file;
};
std::ostream& operator<<(std::ostream& out, const SurfaceCase& c) { return out << c.file; }

class SurfaceAsWritten : public ::testing::TestWithParam<SurfaceCase> {};

// Whatever a program put around it: it is one tetrahedron.
TEST_P(SurfaceAsWritten, IsOneTetrahedron) {
  const ScratchDirectory place;
  const Ended ended =
      hvp(place.path(), {"mesh", (kCases / GetParam().file).string(), "--nodes", "120", "--quiet"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("volume             1.33333 cm3"));
}

INSTANTIATE_TEST_SUITE_P(
    Cases, SurfaceAsWritten,
    ::testing::Values(
        SurfaceCase{"ply-face-texcoord/tetra.ply"}, SurfaceCase{"noise-about-zero/tetra.stl"},
        SurfaceCase{"reader-crashes/no-vt.obj"}, SurfaceCase{"reader-crashes/slash.obj"},
        SurfaceCase{"reader-crashes/no-newline.ply"}, SurfaceCase{"surface-messages/blank.stl"},
        SurfaceCase{"surface-messages/bom.stl"}, SurfaceCase{"surface-messages/name.stl"},
        SurfaceCase{"surface-messages/bom.obj"}, SurfaceCase{"surface-messages/material.obj"},
        SurfaceCase{"surface-messages/nul.obj"}, SurfaceCase{"surface-messages/comment.obj"},
        SurfaceCase{"surface-messages/continued.obj"}),
    [](const auto& test) {
      std::string name = slug(test.param.file);
      std::erase(name, '-');
      return name;
    });

TEST(WholeRun, AMatrixIsRefusedWithTheEntrysLine) {
  const ScratchDirectory place;
  const std::filesystem::path folder = kCases / "matrix-market-line";
  const Ended ended = hvp(place.path(), {"solve", "--matrix", (folder / "twice.mtx").string(),
                                         "--rhs", (folder / "b.mtx").string()});
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, HasSubstr("line 4: entry (1, 1) is given twice, in line 3 too"));
}

}  // namespace
}  // namespace hvp::cli::whole_run_test
