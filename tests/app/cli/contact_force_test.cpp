#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include <gmock/gmock.h>

#include "models/files/csv.h"
#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// The force that a user feels, frame by frame, over the whole range of what could spoil it.
namespace hvp::cli::contact_force_test {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::Not;

struct Felt {
  json summary;
  std::vector<double> force;  // N, a frame
};

Felt felt(const std::string& name, const std::vector<std::string>& sets) {
  const ScratchDirectory place;
  std::vector<std::string> arguments = {
      "run",   scenario(name).string(), "--out", "out",
      "--set", "output.pictures=false", "--set", "output.deformation_every_frames=0",
      "--set", "output.trace_frames=0", "--set", "output.remedies=false"};
  for (const std::string& set : sets) {
    arguments.emplace_back("--set");
    arguments.push_back(set);
  }
  const Ended ended = hvp(place.path(), arguments);
  EXPECT_LT(ended.status, 2) << ended.err;
  Felt result;
  result.summary = json::parse(read(place.path() / "out/summary.json"));
  const std::vector<std::string> rows = lines(read(place.path() / "out/frames.csv"));
  const auto head = files::csv_cells(rows.at(0));
  const auto column =
      static_cast<std::size_t>(std::find(head.begin(), head.end(), "force_N") - head.begin());
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const std::string cell(files::csv_cells(rows[i]).at(column));
    result.force.push_back(cell.empty() ? 0 : std::stod(cell));
  }
  return result;
}

double largest_step(const std::vector<double>& force) {
  double step = 0;
  for (std::size_t i = 1; i < force.size(); ++i) {
    step = std::max(step, std::abs(force[i] - force[i - 1]));
  }
  return step;
}

double peak(const std::vector<double>& force) {
  double largest = 0;
  for (const double f : force) largest = std::max(largest, f);
  return largest;
}

// A collision process as fast as the servo loop, nearly so, a whole ratio of it or none: the static
// force at rest is that of a slow one. A pass that began a hand-over anew would never end it.
TEST(ContactForce, AtRestDoesNotDependOnTheCollisionRate) {
  const auto at_rest = [](const std::string& rate) {
    const Felt f =
        felt("thesis-static.toml", {"frames=450", "reference=false", "host.graphics.rate=" + rate,
                                    "host.graphics.drawing_time=0 s"});
    return f.force.back();
  };
  const double slow = at_rest("20 Hz");
  EXPECT_GT(slow, 0.5);
  for (const char* rate :
       {"33 Hz", "100 Hz", "166.67 Hz", "250 Hz", "251 Hz", "333 Hz", "499 Hz", "499.99 Hz",
        "500 Hz", "500.01 Hz", "501 Hz", "999 Hz", "1000 Hz", "1001 Hz", "2000 Hz"}) {
    EXPECT_NEAR(at_rest(rate), slow, 0.005 * slow) << rate;
  }
}

struct Press {
  std::string name;
  std::string scenario;
  std::vector<std::string> sets;
  double largest_step = 0.1;  // of the peak
  bool rings = false;
};

std::ostream& operator<<(std::ostream& out, const Press& p) { return out << p.name; }

class Step : public ::testing::TestWithParam<Press> {};

// Largest step, the run's own figure, and no ringing. Before nodes were held as they move it was
// 28 times the peak of a patch, and 0.9 of a single node's.
TEST_P(Step, IsBounded) {
  const Press& press = GetParam();
  const Felt f = felt(press.scenario, press.sets);
  const double share = largest_step(f.force) / peak(f.force);
  EXPECT_GT(peak(f.force), 0.5);
  EXPECT_LT(share, press.largest_step);
  const json& force = f.summary.at("force");
  // The file has magnitudes: where the direction turns, the step is no smaller than that.
  EXPECT_GE(force.at("step").at("N").get<double>(), largest_step(f.force) * (1 - 1e-9));
  EXPECT_NEAR(force.at("largest").at("N").get<double>(), peak(f.force), 1e-6);
  EXPECT_EQ(f.summary.at("stability").at("flags").dump().find("force-ringing") != std::string::npos,
            press.rings);
  const json& handed_over = force.at("handed_over");
  const bool flagged = force.at("step").at("of_largest_rel") > 0.1 ||
                       handed_over.at("within_30_ms_rel") > 0.1 ||
                       handed_over.at("within_100_ms_rel") > 0.1;
  EXPECT_EQ(f.summary.at("stability").at("flags").dump().find("force-step") != std::string::npos,
            flagged);
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, Step,
    ::testing::Values(
        Press{"Static", "thesis-static.toml", {"reference=false"}},
        Press{"Dynamic", "thesis.toml", {"reference=false"}},
        Press{"Refined", "thesis-refined.toml", {"reference=false"}},
        // 4.4 % of a peak of some 10 N was measured on a prototype.
        Press{
            "Patch", "thesis-refined.toml", {"reference=false", "contact.patch_radius=12mm"}, 0.08},
        // Each step of the encoder, divided by the period, is a velocity of 27 mm/s.
        Press{"PatchAndEncoder",
              "thesis-refined.toml",
              {"reference=false", "contact.patch_radius=12mm", "device.encoder=true"},
              0.16,
              true},
        Press{"Undamped",
              "thesis-refined.toml",
              {"reference=false", "dynamics.newmark_gamma=0.5", "dynamics.newmark_beta=0.5",
               "dynamics.rayleigh_mass=0 1/s", "dynamics.rayleigh_stiffness=0 s"}},
        Press{"UndampedPatch",
              "thesis-refined.toml",
              {"reference=false", "dynamics.newmark_gamma=0.5", "dynamics.newmark_beta=0.5",
               "dynamics.rayleigh_mass=0 1/s", "dynamics.rayleigh_stiffness=0 s",
               "contact.patch_radius=12mm"}},
        Press{"OneKilohertz",
              "thesis-refined.toml",
              {"reference=false", "budget.period=1ms", "frames=2000",
               "host.sustained_rate=3 Gflop/s"}}),
    [](const auto& test) { return test.param.name; });

// The thesis' letter jumps, as it did, and the run says so.
TEST(ContactForce, WithoutAHandOverAPatchRingsAndIsFlagged) {
  const Felt f = felt("thesis-refined.toml", {"reference=false", "contact.patch_radius=12mm",
                                              "contact.hand_over=0s", "frames=900"});
  EXPECT_GT(largest_step(f.force), 5);
  EXPECT_THAT(f.summary.at("stability").at("flags"), Contains("force-step"));
  EXPECT_THAT(f.summary.at("stability").at("flags"), Contains("force-ringing"));
}

// A body that is held still: rounding keeps plain CG moving, a preconditioner lets it rest.
TEST(ContactForce, ThatMovesWhileTheTipRestsIsFlagged) {
  const std::vector<std::string> held = {
      "reference=false", "frames=1500",
      "probe.motion=[{phase=\"approach\", to=[\"0 mm\", \"0 mm\", \"50 mm\"], "
      "duration=\"200 ms\"}, {phase=\"press\", to=[\"0 mm\", \"0 mm\", \"45 mm\"], "
      "duration=\"400 ms\"}]"};
  const Felt plain = felt("thesis.toml", held);
  EXPECT_THAT(plain.summary.at("stability").at("flags"), Contains("limit-cycle"));
  EXPECT_GT(plain.summary.at("force").at("ripple_rel"), 0.015);
  std::vector<std::string> with = held;
  for (const char* set : {"solver.method=jacobi-pcg", "accelerator.partitions=3"}) {
    with.emplace_back(set);
  }
  const Felt preconditioned = felt("thesis.toml", with);
  EXPECT_THAT(preconditioned.summary.at("stability").at("flags"), Not(Contains("limit-cycle")));
  EXPECT_LT(preconditioned.summary.at("force").at("ripple_rel"), 0.002);
}

// Through the body: no linear model says anything of that.
TEST(ContactForce, OfABodyPressedThroughIsFlagged) {
  const Felt f = felt("thesis-static.toml",
                      {"reference=false", "frames=600", "solver.displacement_range=200 mm",
                       "probe.motion=[{phase=\"approach\", to=[\"0 mm\", \"0 mm\", \"50 mm\"], "
                       "duration=\"200 ms\"}, {phase=\"press\", to=[\"0 mm\", \"0 mm\", "
                       "\"-30 mm\"], duration=\"800 ms\"}]"});
  EXPECT_THAT(f.summary.at("stability").at("flags"), Contains("beyond-linearity"));
  EXPECT_GT(f.summary.at("strain").at("inverted_elements"), 0);
  EXPECT_GT(f.summary.at("strain").at("largest"), 1);
}

}  // namespace
}  // namespace hvp::cli::contact_force_test
