#include "app/scenario/reader.h"

#include <gtest/gtest.h>

#include "tests/app/scenario/read_toy.h"

namespace hvp::scenario::reader_test {
namespace {

using toy::error_of;
using toy::read_scene;
using toy::Scene;

TEST(Reader, LeavesDefaultsWhereTheScenarioIsSilent) {
  Scene expected;
  expected.title = "x";
  EXPECT_EQ(read_scene("title = 'x'"), expected);
}

TEST(Reader, ReadsEveryKindOfParameter) {
  const Scene scene = read_scene(R"(
title = "a scene"
[budget]
period = "1 ms"
[solver]
method = "cg"
iterations = 30
tolerance = 1e-6
warm_start = false
[host]
copy_rate = "1.5 Gflop/s"
[host.jitter]
seed = -9223372036854775808
[object]
surface = "body.stl"
density = "0.9 g/cm3"
gravity = ["0 m/s2", "1 g", "-9.81 m/s2"]
axis = [1, 0.5, -1.0]
[[contacts]]
at = ["1 mm", "20 um", "-3 cm"]
depth = "1 mm"
[[contacts]]
depth = "2 mm"
shape = {radius = "3 mm"}
)");
  EXPECT_EQ(scene.title, "a scene");
  EXPECT_EQ(scene.budget.period, 1e-3);
  EXPECT_EQ(scene.solver.method, toy::Solver::Method::cg);
  EXPECT_EQ(scene.solver.iterations, 30);
  EXPECT_EQ(scene.solver.tolerance, 1e-6);
  EXPECT_FALSE(scene.solver.warm_start);
  EXPECT_EQ(scene.host.copy_rate, 1.5e9);
  ASSERT_TRUE(scene.host.jitter.has_value());
  EXPECT_EQ(scene.host.jitter->seed, std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(scene.host.jitter->sigma, 10e-6);
  EXPECT_EQ(scene.object.surface.written, "body.stl");
  EXPECT_EQ(scene.object.density, 900.0);
  EXPECT_EQ(scene.object.gravity, Eigen::Vector3d(0.0, 9.80665, -9.81));
  EXPECT_EQ(scene.object.axis, Eigen::Vector3d(1.0, 0.5, -1.0));
  ASSERT_EQ(scene.contacts.size(), 2U);
  EXPECT_EQ(scene.contacts[0].at, Eigen::Vector3d(1e-3, 20e-6, -3e-2));
  EXPECT_EQ(scene.contacts[1].at, toy::kTop);
  EXPECT_EQ(scene.contacts[1].shape.radius, 3e-3);
}

TEST(Reader, TakesAnEffectThatTheStructStartsWithOutAgain) {
  Scene scene;
  scene.host.jitter.emplace();
  read(Document::parse("title = 'x'", "x.toml"), scene);
  EXPECT_FALSE(scene.host.jitter.has_value());
}

TEST(Reader, ReplacesADefaultListAsAWhole) {
  Scene scene;
  scene.contacts.resize(2);
  scene.contacts[0].shape.radius = 7.0;
  read(Document::parse("title = 'x'\n[[contacts]]\ndepth = '1 mm'", "x.toml"), scene);
  ASSERT_EQ(scene.contacts.size(), 1U);
  EXPECT_EQ(scene.contacts[0].shape.radius, toy::Shape{}.radius);
}

TEST(Reader, KeepsADefaultListThatTheScenarioDoesNotHave) {
  Scene scene;
  scene.contacts.resize(2);
  read(Document::parse("title = 'x'", "x.toml"), scene);
  EXPECT_EQ(scene.contacts.size(), 2U);
}

struct Case {
  const char* text;
  const char* error;
};

class ReaderError : public testing::TestWithParam<Case> {};

TEST_P(ReaderError, IsOneCompleteLine) { EXPECT_EQ(error_of(GetParam().text), GetParam().error); }

INSTANTIATE_TEST_SUITE_P(
    UnknownKeys, ReaderError,
    testing::Values(
        Case{"title='x'\n[solver]\niteratons = 30",
             "x.toml:3: solver.iteratons: unknown key; did you mean \"iterations\"?"},
        Case{"title='x'\n[budget]\niterations = 30",
             "x.toml:3: budget.iterations: unknown key; did you mean \"solver.iterations\"?"},
        Case{"title='x'\nradius = '1 mm'",
             "x.toml:2: radius: unknown key; did you mean \"contacts.shape.radius\"?"},
        Case{"title='x'\n[jitter]\nsigma = '1 us'",
             "x.toml:2: jitter: unknown key; did you mean \"host.jitter\"?"},
        Case{"title='x'\n[slover]\niterations = 30",
             "x.toml:2: slover: unknown key; did you mean \"solver\"?"},
        Case{"title='x'\n[host.jiter]\nsigma = '1 us'",
             "x.toml:2: host.jiter: unknown key; did you mean \"jitter\"?"},
        Case{"title='x'\n[solver]\ncolour = 3",
             "x.toml:3: solver.colour: unknown key; [solver] has method, iterations, tolerance, "
             "warm_start"},
        Case{"title='x'\n[[contacts]]\ndepth='1 mm'\n[[contacts]]\ndept='1 mm'",
             "x.toml:5: contacts[1].dept: unknown key; did you mean \"depth\"?"},
        Case{"title='x'\n[solver]\n\"a\\nb\" = 3",
             "x.toml:3: solver.\"a\\nb\": unknown key; [solver] has method, iterations, tolerance, "
             "warm_start"}));

INSTANTIATE_TEST_SUITE_P(
    Quantities, ReaderError,
    testing::Values(
        Case{"title='x'\n[budget]\nperiod = 2",
             "x.toml:3: budget.period: missing unit: expected a time such as \"2 ms\", found 2"},
        Case{"title='x'\n[budget]\nperiod = 0.5",
             "x.toml:3: budget.period: missing unit: expected a time such as \"2 ms\", found 0.5"},
        Case{"title='x'\n[budget]\nperiod = '10 kPa'",
             "x.toml:3: budget.period: wrong unit: expected a time such as \"2 ms\", found the "
             "pressure \"10 kPa\""},
        Case{"title='x'\n[budget]\nperiod = '0 s'",
             "x.toml:3: budget.period: out of range: expected more than 0 s, found 0 s"},
        Case{"title='x'\n[budget]\nperiod = true",
             "x.toml:3: budget.period: expected a time such as \"2 ms\", found true"},
        Case{"title='x'\n[budget]\nperiod = 1979-05-27",
             "x.toml:3: budget.period: expected a time such as \"2 ms\", found a date or time"},
        Case{"title='x'\n[object]\nyoung = '2 THz'",
             "x.toml:3: object.young: unknown unit \"THz\": expected a pressure such as "
             "\"10 kPa\", found \"2 THz\""},
        Case{"title='x'\n[object]\nyoung = '2000 GPa'",
             "x.toml:3: object.young: out of range: expected from 1 Pa to 1000 GPa, found "
             "2000 GPa"},
        Case{"title='x'\n[solver]\ntolerance = 1.0",
             "x.toml:3: solver.tolerance: out of range: expected at least 0 and less than 1, "
             "found 1.0"},
        Case{"title='x'\n[solver]\ntolerance = nan",
             "x.toml:3: solver.tolerance: expected a finite number, found nan"},
        Case{"title='x'\n[solver]\ntolerance = '0.1'",
             "x.toml:3: solver.tolerance: expected a number such as 0.5, found \"0.1\""}));

INSTANTIATE_TEST_SUITE_P(
    Types, ReaderError,
    testing::Values(
        Case{"title = 3", "x.toml:1: title: expected a text in quotes, found 3"},
        Case{"title='x'\n[solver]\niterations = 60.0",
             "x.toml:3: solver.iterations: expected a whole number, found 60.0"},
        Case{"title='x'\n[solver]\niterations = 0",
             "x.toml:3: solver.iterations: out of range: expected from 1 to 500, found 0"},
        Case{"title='x'\n[solver]\niterations = 4294967297",
             "x.toml:3: solver.iterations: out of range: expected from 1 to 500, found "
             "4294967297"},
        Case{"title='x'\n[solver]\nwarm_start = 1",
             "x.toml:3: solver.warm_start: expected true or false, found 1"},
        Case{"title='x'\n[solver]\nmethod = 'pgc'",
             "x.toml:3: solver.method: expected \"cg\" or \"pcg\", found \"pgc\"; did you mean "
             "\"pcg\"?"},
        Case{"title='x'\n[solver]\nmethod = 1",
             "x.toml:3: solver.method: expected \"cg\" or \"pcg\", found 1"},
        Case{"title='x'\nsolver = 3", "x.toml:2: solver: expected a table [solver], found 3"},
        Case{"title='x'\n[[solver]]\nx=1",
             "x.toml:2: solver: expected a table [solver], found a list of 1"},
        Case{"title='x'\n[host]\njitter = true",
             "x.toml:3: host.jitter: expected a table [host.jitter], found true"},
        Case{"title='x'\n[contacts]\ndepth='1 mm'",
             "x.toml:2: contacts: expected a list of tables [[contacts]], found a table"},
        Case{"title='x'\ncontacts = [{depth='1 mm'}, 3]",
             "x.toml:2: contacts[1]: expected a table, found 3"},
        Case{"title='x'\n[object]\ngravity = '1 g'",
             "x.toml:3: object.gravity: expected a list of three components, each an acceleration "
             "such as \"9.81 m/s2\", found \"1 g\""},
        Case{"title='x'\n[object]\ngravity = ['1 g']",
             "x.toml:3: object.gravity: expected a list of three components, each an acceleration "
             "such as \"9.81 m/s2\", found a list of 1"},
        Case{"title='x'\n[object]\ngravity = ['1 g',\n '1 g',\n '1 m']",
             "x.toml:5: object.gravity[2]: wrong unit: expected an acceleration such as "
             "\"9.81 m/s2\", found the length \"1 m\""},
        Case{"title='x'\n[object]\nsurface = 1",
             "x.toml:3: object.surface: expected a file name in quotes, found 1"}));

INSTANTIATE_TEST_SUITE_P(
    MissingKeysAndRules, ReaderError,
    testing::Values(Case{"[solver]\niterations = 3",
                         "x.toml:1: title: missing required key: one line"},
                    Case{"title='x'\n\n[[contacts]]\nat=['1 m','0 m','0 m']",
                         "x.toml:3: contacts[0].depth: missing required key: how deep"},
                    Case{"title='x'\n[solver]\nmethod='cg'\niterations=450",
                         "x.toml:4: solver.iterations: CG takes at most 400, found 450"},
                    Case{"title='x'\n[[contacts]]\ndepth='1 m'\nat=['0 m','0 m','0 m']",
                         "x.toml:4: contacts[0].at: lies at the centre"},
                    // The rule names a key of a table below that stands at its default.
                    Case{"title='x'\n[budget]\nperiod='1 us'\n[host.jitter]",
                         "x.toml:4: host.jitter.sigma: exceeds the period"}));

INSTANTIATE_TEST_SUITE_P(
    TheFirstOfSeveral, ReaderError,
    testing::Values(
        Case{"[solver]\nwarm_start = 1\n[budget]\nperiod = 2",
             "x.toml:2: solver.warm_start: expected true or false, found 1"},
        Case{"[solver]\niteratons = 3\ntolerance = '1'",
             "x.toml:2: solver.iteratons: unknown key; did you mean \"iterations\"?"},
        // A rule does not see a part while something else is wrong.
        Case{"title=3\n[[contacts]]\ndepth='1 m'\nat=['0 m','0 m','0 m']",
             "x.toml:1: title: expected a text in quotes, found 3"},
        // What belongs to a table is not known while the name that decides it is wrong.
        Case{"title='x'\n[solver]\nextra = 3\nmethod = 'gc'",
             "x.toml:4: solver.method: expected \"cg\" or \"pcg\", found \"gc\"; did you mean "
             "\"cg\"?"}));

}  // namespace
}  // namespace hvp::scenario::reader_test
