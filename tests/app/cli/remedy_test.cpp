#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// A remedy that is printed is run, as printed: the scenario with it has the flags that the line
// says stay, and fits its device.
namespace hvp::cli::remedy_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

struct Trouble {
  std::string name;
  std::string scenario;  // of the project's; empty: kSmallScene
  std::vector<std::string> changes;
  std::vector<std::string> raises;      // at least
  std::vector<std::string> remedy;      // begins with; empty: whatever works
  std::vector<std::string> keeps = {};  // flags that no setting helps against
};

std::ostream& operator<<(std::ostream& out, const Trouble& t) { return out << t.name; }

class Remedy : public ::testing::TestWithParam<Trouble> {
 protected:
  json run(const std::vector<std::string>& changes) {
    std::vector<std::string> arguments = {"run", file().string(), "--out",
                                          "out", "--set",         "output.pictures=false"};
    for (const std::string& change : changes) {
      arguments.emplace_back("--set");
      arguments.push_back(change);
    }
    const Ended ended = hvp(place_.path(), arguments);
    EXPECT_LT(ended.status, 2) << ended.err;
    out_ = ended.out;
    return json::parse(read(place_.path() / "out/summary.json"));
  }
  std::filesystem::path file() {
    if (!GetParam().scenario.empty()) return scenario(GetParam().scenario);
    write(place_.path() / "s.toml", kSmallScene);
    return "s.toml";
  }

  ScratchDirectory place_;
  std::string out_;
};

TEST_P(Remedy, WorksAsPrinted) {
  const Trouble& trouble = GetParam();
  const json before = run(trouble.changes);
  const json flags = before.at("stability").at("flags");
  for (const std::string& flag : trouble.raises) EXPECT_THAT(flags, testing::Contains(flag));
  EXPECT_NE(before.at("verdict"), "PASS");
  const json remedy = before.at("remedy");
  ASSERT_FALSE(remedy.is_null()) << flags;
  // It was run whole, and says what it leaves.
  EXPECT_TRUE(remedy.at("whole_run"));
  ASSERT_EQ(remedy.at("leaves"), json(trouble.keeps)) << remedy;
  EXPECT_EQ(remedy.at("works"), trouble.keeps.empty());
  std::vector<std::string> changes = trouble.changes;
  std::string line;
  for (const json& setting : remedy.at("set")) {
    changes.push_back(setting.get<std::string>());
    line += (line.empty() ? "--set " : " --set ") + changes.back();
  }
  EXPECT_THAT(out_, HasSubstr("what would help " + line + "\n"));
  for (std::size_t i = 0; i < trouble.remedy.size(); ++i) {
    ASSERT_LT(i, remedy.at("set").size()) << remedy;
    EXPECT_EQ(remedy.at("set").at(i), trouble.remedy[i]);
  }

  const json after = run(changes);
  EXPECT_EQ(after.at("stability").at("flags"), json(trouble.keeps)) << line;
  for (const json& resource : after.at("resources")) {
    EXPECT_LE(resource.at("used"), resource.at("available")) << resource.at("type");
  }
}

INSTANTIATE_TEST_SUITE_P(
    Scenarios, Remedy,
    ::testing::Values(
        Trouble{"thesis",
                "thesis.toml",
                {},
                {"matrix-rounding", "not-converged", "force-step"},
                {"solver.iterations=15", "refinement.passes=2", "contact.kind=proxy"}},
        Trouble{"refined", "thesis-refined.toml", {}, {"force-step"}, {"contact.kind=proxy"}},
        Trouble{"without-a-reference",
                "thesis.toml",
                {"reference=false", "loads.gravity=true", "frames=400"},
                {"matrix-rounding"},
                {}},
        Trouble{"consistent-mass",
                "thesis.toml",
                {"dynamics.mass=consistent", "frames=700"},
                {"matrix-rounding"},
                {},
                {"force-step"}},
        // The proxy, and what the words of a run with a proxy need.
        Trouble{"static",
                "thesis-static.toml",
                {},
                {"matrix-rounding", "force-step"},
                {"contact.kind=proxy"}},
        Trouble{"range",
                "thesis-static.toml",
                {"solver.displacement_range=1mm", "reference=false", "frames=500",
                 "solver.matrix_scaling=diagonal"},
                {"range-exceeded"},
                {}},
        Trouble{"static-shift",
                "thesis-static.toml",
                {"solver.static_shift=7", "reference=false", "frames=500"},
                {"range-exceeded"},
                {}},
        Trouble{"wrap",
                "",
                {"solver.overflow=wrap", "solver.displacement_range=1 mm"},
                {"wrapped"},
                {}},
        Trouble{"narrow-matrix",
                "",
                {"solver.matrix_bits=8", "reference.tolerance=0.01"},
                {"matrix-rounding"},
                {}},
        Trouble{"few-iterations", "", {"solver.iterations=2"}, {"not-converged"}, {}},
        Trouble{"locking",
                "",
                {"object.material.poisson_ratio=0.49", "object.mesh.nodes=120"},
                {"locking"},
                {"object.elements=quadratic-mean-dilatation"}},
        // A point is too soft for a probe larger than an element.
        Trouble{"large-probe",
                "slide.toml",
                {"probe.radius=8 mm", "frames=500"},
                {"contact-doubtful"},
                {"contact.kind=patch"}},
        // To the letter of thesis §3.7 a patch jumps, and rings.
        Trouble{"jump",
                "thesis-refined.toml",
                {"contact.hand_over=0s", "contact.patch_radius=12mm", "frames=900"},
                {"force-step", "force-ringing"},
                {"contact.hand_over=20ms"},
                {"force-step", "contact-missed"}}),
    [](const auto& test) {
      std::string name = slug(test.param.name);
      std::erase(name, '-');
      return name;
    });

// What it says of time is what the run then takes, to a hundredth: accesses and interrupts of
// further passes are not among a frame's large steps.
TEST(RemedyCosts, AreThoseOfItsRun) {
  const ScratchDirectory place;
  const auto run = [&](const char* name, std::vector<std::string> changes) {
    std::vector<std::string> arguments = {"run",   scenario(name).string(), "--out", "out",
                                          "--set", "output.pictures=false"};
    for (std::string& change : changes) {
      arguments.emplace_back("--set");
      arguments.push_back(std::move(change));
    }
    hvp(place.path(), arguments);
    return json::parse(read(place.path() / "out/summary.json"));
  };
  for (const char* name : {"thesis-static.toml", "thesis.toml"}) {
    SCOPED_TRACE(name);
    const json remedy = run(name, {}).at("remedy");
    const json after = run(name, remedy.at("set").get<std::vector<std::string>>());
    const double latency = after.at("deadline").at("worst_us");
    const double load = after.at("load").at("worst_us");
    EXPECT_NEAR(remedy.at("latency_us"), latency, 0.01 * latency);
    EXPECT_NEAR(remedy.at("load_us"), load, 0.01 * load);
    EXPECT_TRUE(remedy.at("in_time"));
  }
  // With a period that it does not fit into it says so.
  const json tight = run("thesis-static.toml", {"budget.period=770 us"});
  EXPECT_FALSE(tight.at("remedy").at("in_time"));
}

// The host solves: there is no board to ask about.
TEST(RemedyOfAHost, IsOfTheHandOverAlone) {
  const ScratchDirectory place;
  const Ended ended =
      hvp(place.path(), {"run", scenario("thesis.toml").string(), "--out", "out", "--set",
                         "output.pictures=false", "--set", "host.solver=cholesky", "--set",
                         "contact.hand_over=0 s", "--set", "frames=400"});
  EXPECT_LT(ended.status, 2) << ended.err;
  const json remedy = json::parse(read(place.path() / "out/summary.json")).at("remedy");
  EXPECT_TRUE(remedy.at("works"));
  EXPECT_EQ(remedy.at("set"), json({"contact.hand_over=20ms"}));
}

// A body that the host solves by itself: the key and the number that the run's own limit asks for.
TEST(RemedyOfAHost, IsOfItsStepsAndPasses) {
  const ScratchDirectory place;
  const auto run = [&](std::vector<std::string> changes) {
    std::vector<std::string> arguments = {"run",   scenario("thesis-nonlinear.toml").string(),
                                          "--out", "out",
                                          "--set", "output.pictures=false",
                                          "--set", "host.sustained_rate=100Gflop/s",
                                          "--set", "output.deformation_every_frames=0"};
    for (std::string& change : changes) {
      arguments.emplace_back("--set");
      arguments.push_back(std::move(change));
    }
    EXPECT_LT(hvp(place.path(), arguments).status, 2);
    return json::parse(read(place.path() / "out/summary.json"));
  };
  // Three steps a frame are of 667 us, and pressed by 20 mm this body is stable below 556 us.
  std::vector<std::string> steps = {"refinement=false",
                                    "host.solver=explicit",
                                    "frames=300",
                                    "reference=false",
                                    "contact.patch_radius=15mm",
                                    "host.substeps=3",
                                    "probe.motion=[{phase=\"press\",to=[\"0mm\",\"0mm\",\"20mm\"],"
                                    "duration=\"500ms\"}]"};
  // One pass leaves more than [refinement] asks for.
  std::vector<std::string> passes = {"host.solver=cholesky", "frames=350", "refinement.passes=1"};
  for (std::vector<std::string>& changes : {std::ref(steps), std::ref(passes)}) {
    const json before = run(changes);
    const json remedy = before.at("remedy");
    ASSERT_FALSE(remedy.is_null()) << before.at("stability").at("flags");
    EXPECT_TRUE(remedy.at("works")) << remedy;
    EXPECT_TRUE(remedy.at("whole_run"));
    for (const json& setting : remedy.at("set")) changes.push_back(setting.get<std::string>());
    EXPECT_EQ(run(changes).at("stability").at("flags"), json::array()) << remedy;
  }
  EXPECT_EQ(steps.back(), "host.substeps=4");
  EXPECT_EQ(passes.back(), "refinement.passes=2");
}

// Pressed so deep that no number of passes leads to the forces with the matrix at rest, a host's
// body has a matrix that is renewed; it is run as it is printed, and sets no key twice.
TEST(Remedy, OfAHostsBodyIsAMatrixThatIsRenewed) {
  const ScratchDirectory place;
  std::vector<std::string> arguments = {"run", scenario("tissue-renewed.toml").string(), "--out",
                                        "out"};
  const auto set = [&](const std::string& setting) {
    arguments.insert(arguments.end(), {"--set", setting});
  };
  for (const char* const setting :
       {"output.remedies=true", "output.pictures=false", "output.deformation_every_frames=0",
        "reference=false", "frames=220", "host.solver=cholesky", "host.sustained_rate=1 Tflop/s",
        "contact.kind=proxy", "refinement.passes=1", "object.model.matrix.renew_every=0",
        "probe.motion=[{phase=\"press\",to=[\"0mm\",\"0mm\",\"34mm\"],duration=\"300ms\"},"
        "{phase=\"slide\",to=[\"12mm\",\"0mm\",\"34mm\"],duration=\"200ms\"}]"}) {
    set(setting);
  }
  ASSERT_LT(hvp(place.path(), arguments).status, 2);
  const json remedy = json::parse(read(place.path() / "out/summary.json")).at("remedy");
  std::set<std::string> keys;
  for (const json& setting : remedy.at("set")) {
    const std::string text = setting;
    EXPECT_TRUE(keys.insert(text.substr(0, text.find('='))).second) << remedy;
    set(text);
  }
  EXPECT_TRUE(keys.contains("object.model.matrix.renew_every")) << remedy;
  set("output.remedies=false");
  ASSERT_LT(hvp(place.path(), arguments).status, 2);
  const json flags =
      json::parse(read(place.path() / "out/summary.json")).at("stability").at("flags");
  EXPECT_THAT(flags, Not(::testing::Contains("divergence")));
  EXPECT_THAT(flags, Not(::testing::Contains("not-converged")));
}

// Whatever a scenario's line looks like, the shell's quotes around it are enough.
TEST(Override, TakesALineAsAScenarioHasIt) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", kSmallScene);
  const Ended ended =
      hvp(place.path(), {"run", "s.toml", "--out", "out", "--set", "solver.start = \"zero\"",
                         "--set", " frames = 5 ", "--set", "budget.period = \"4 ms\""});
  EXPECT_EQ(ended.status, 0) << ended.err;
  const json summary = json::parse(read(place.path() / "out/summary.json"));
  EXPECT_EQ(summary.at("deadline").at("frames"), 5);
  EXPECT_EQ(summary.at("deadline").at("period_us"), 4000);
  EXPECT_THAT(read(place.path() / "out/scenario.resolved.toml"), HasSubstr("start = \"zero\""));
}

TEST(Override, OfBlanksIsNone) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", kSmallScene);
  const Ended ended = hvp(place.path(), {"run", "s.toml", "--set", "  = 3"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, HasSubstr("expected KEY=VALUE"));
}

// A what-if does not overwrite the run that it is compared with, nor look like it.
TEST(WhatIf, HasAFolderAndATitleOfItsOwn) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", kSmallScene);
  const auto run_with = [&](const std::vector<std::string>& changes) {
    std::vector<std::string> arguments = {"run", "s.toml"};
    for (const std::string& change : changes) {
      arguments.emplace_back("--set");
      arguments.push_back(change);
    }
    EXPECT_EQ(hvp(place.path(), arguments).status, 0);
  };
  run_with({});
  run_with({"frames=7"});
  run_with({"bus.kind=pci-64/66", "frames=7"});
  EXPECT_THAT(names(place.path() / "runs"),
              testing::ElementsAre("s", "s+bus.kind=pci-64-66+frames=7", "s+frames=7"));
  const auto title = [&](const std::string& folder) {
    return json::parse(read(place.path() / "runs" / folder / "summary.json")).at("title");
  };
  EXPECT_EQ(title("s+frames=7"), title("s").get<std::string>() + " [frames=7]");
}

}  // namespace
}  // namespace hvp::cli::remedy_test
