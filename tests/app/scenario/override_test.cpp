#include <gtest/gtest.h>

#include "tests/app/scenario/read_toy.h"

namespace hvp::scenario::override_test {
namespace {

using toy::error_of;
using toy::read_scene;
using toy::Scene;

constexpr const char* kText = R"(
title = "a scene"
[solver]
iterations = 30
[host.jitter]
sigma = "5 us"
[[contacts]]
depth = "1 mm"
)";

TEST(Override, ReplacesAndAdds) {
  const Scene scene = read_scene(
      kText, {"solver.iterations=40", "budget.period=4 ms", "solver.method=cg", "title=2024",
              "object.axis=[0, 1, 0]", "object.gravity=['1 g', '0 m/s2', '0 m/s2']",
              "contacts[0].depth=\"2 mm\"", "contacts[1].depth=3mm", "solver.iterations=41"});
  EXPECT_EQ(scene.solver.iterations, 41) << "the last override wins";
  EXPECT_EQ(scene.solver.method, toy::Solver::Method::cg);
  EXPECT_EQ(scene.budget.period, 4e-3);
  EXPECT_EQ(scene.title, "2024");
  EXPECT_EQ(scene.object.axis, Eigen::Vector3d::UnitY());
  EXPECT_EQ(scene.object.gravity[0], 9.80665);
  ASSERT_EQ(scene.contacts.size(), 2U);
  EXPECT_EQ(scene.contacts[0].depth, 2e-3);
  EXPECT_EQ(scene.contacts[1].depth, 3e-3);
}

TEST(Override, ReplacesOneComponentOfAVector) {
  const Scene scene = read_scene("title='x'\n[object]\naxis=[0, 0, 1]", {"object.axis[2]=-1"});
  EXPECT_EQ(scene.object.axis, Eigen::Vector3d(0.0, 0.0, -1.0));
}

TEST(Override, SwitchesEffects) {
  EXPECT_FALSE(read_scene(kText, {"host.jitter=false"}).host.jitter.has_value());
  EXPECT_EQ(read_scene(kText, {"host.jitter=true"}).host.jitter->sigma, 5e-6);
  EXPECT_EQ(read_scene("title='x'", {"host.jitter=true"}).host.jitter, toy::Jitter{});
  EXPECT_EQ(read_scene("title='x'", {"host.jitter={}"}).host.jitter, toy::Jitter{});
  EXPECT_EQ(read_scene("title='x'", {"host.jitter.seed=7"}).host.jitter->seed, 7);
  EXPECT_EQ(read_scene("title='x'", {"host.jitter=true", "host.jitter.seed=7"}).host.jitter->seed,
            7);
}

struct Case {
  const char* override_text;
  const char* error;
};

class OverrideError : public testing::TestWithParam<Case> {};

TEST_P(OverrideError, IsOneCompleteLine) {
  EXPECT_EQ(error_of(kText, {GetParam().override_text}), GetParam().error);
}

INSTANTIATE_TEST_SUITE_P(
    All, OverrideError,
    testing::Values(
        Case{"solver.iterations=abc",
             "--set solver.iterations=abc: expected a whole number, found \"abc\""},
        Case{"solver.iteratons=3",
             "--set solver.iteratons=3: unknown key; did you mean \"iterations\"?"},
        Case{"slover.iterations=3",
             "--set slover.iterations=3: slover: unknown key; did you mean \"solver\"?"},
        Case{"solver={iteratons=3}",
             "--set solver={iteratons=3}: solver.iteratons: unknown key; did you mean "
             "\"iterations\"?"},
        Case{"budget.period=2",
             "--set budget.period=2: missing unit: expected a time such as \"2 ms\", found 2"},
        Case{"contacts[1].at=['1 m','1 m','1 m']",
             "--set contacts[1].at=['1 m','1 m','1 m']: contacts[1].depth: missing required key: "
             "how deep"},
        Case{"contacts[5].depth=1 mm",
             "--set contacts[5].depth=1 mm: index 5 is beyond contacts, which has 1 item in the "
             "scenario; 1 appends"},
        Case{"solver.iterations.x=3",
             "--set solver.iterations.x=3: solver.iterations is 30: expected a table"},
        Case{"solver[0]=3", "--set solver[0]=3: solver is a table, not a list"},
        Case{"solver.iterations",
             "--set solver.iterations: expected KEY=VALUE, such as "
             "object.mesh.nodes=300"},
        Case{"=3", "--set =3: expected KEY=VALUE, such as object.mesh.nodes=300"},
        Case{"a..b=3",
             "--set a..b=3: expected KEY=VALUE with a key such as object.mesh.nodes or "
             "fault[0].frame"},
        Case{"a[x]=3",
             "--set a[x]=3: expected KEY=VALUE with a key such as object.mesh.nodes or "
             "fault[0].frame"},
        Case{"solver.iterations=", "--set solver.iterations=: expected a whole number, found \"\""},
        Case{"solver.method=pgc",
             "--set solver.method=pgc: expected \"cg\" or \"pcg\", found \"pgc\"; did you mean "
             "\"pcg\"?"},
        // A line break would smuggle in a key of its own.
        Case{"solver.iterations=3\ntitle='y'",
             "--set solver.iterations=3\\ntitle='y': expected a whole number, found "
             "\"3\\ntitle='y'\""}));

TEST(Override, ReportsBrokenTomlAsSuch) {
  const std::string error = error_of(kText, {"object.axis=[1, 2"});
  EXPECT_TRUE(error.starts_with("--set object.axis=[1, 2: TOML syntax: ")) << error;
}

TEST(Override, FileErrorsComeFirst) {
  EXPECT_EQ(error_of("title=3", {"solver.iterations=abc"}),
            "x.toml:1: title: expected a text in quotes, found 3");
}

}  // namespace
}  // namespace hvp::scenario::override_test
