#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// Device, hand and wall as a user meets them: `hvp run` and `hvp stability`.
namespace hvp::cli::closed_loop_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class LoopCommands : public ::testing::Test {
 protected:
  Ended with(std::string command, const std::vector<std::string>& settings,
             const std::string& name = "wall.toml") const {
    std::vector<std::string> arguments = {std::move(command), scenario(name).string()};
    for (const std::string& setting : settings) {
      arguments.emplace_back("--set");
      arguments.push_back(setting);
    }
    if (arguments.front() == "run") {
      arguments.insert(arguments.end(), {"--out", "out", "--set", "output.pictures=false"});
    }
    if (arguments.front() == "stability") arguments.emplace_back("--json");
    return hvp(place_.path(), arguments);
  }
  json run(const std::vector<std::string>& settings) const {
    const Ended ended = with("run", settings);
    EXPECT_EQ(ended.status, 0) << ended.err;
    return json::parse(read(place_.path() / "out/summary.json"));
  }
  json stability(const std::vector<std::string>& settings) const {
    const Ended ended = with("stability", settings);
    EXPECT_EQ(ended.status, 0) << ended.err;
    return json::parse(ended.out);
  }
  void expect_refused(const std::vector<std::string>& settings, const std::string& words,
                      const std::string& command = "run") const {
    const Ended ended = with(command, settings);
    EXPECT_EQ(ended.status, 2) << ended.out;
    EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(words));
  }

  const ScratchDirectory place_;
};

// The exact discrete eigenvalues, found elsewhere (docs/stability.md): m = 0.1 kg, b = 1 N s/m,
// T = 2 ms.
struct KnownEdge {
  std::vector<std::string> settings;
  double stiffness;
};
void PrintTo(const KnownEdge& edge, std::ostream* out) {
  for (const std::string& setting : edge.settings) *out << setting << ' ';
}
class KnownStability : public LoopCommands, public ::testing::WithParamInterface<KnownEdge> {};

TEST_P(KnownStability, IsFoundByRunsAndByEigenvalues) {
  const json j = stability(GetParam().settings);
  EXPECT_NEAR(j.at("stiffness_max"), GetParam().stiffness, 0.005 * GetParam().stiffness);
  EXPECT_NEAR(j.at("stiffness_linear"), GetParam().stiffness, 0.002 * GetParam().stiffness);
  EXPECT_LE(j.at("stiffness_passive"), j.at("stiffness_max"));
  EXPECT_GT(j.at("unstable_from"), j.at("stiffness_max"));
  EXPECT_GT(j.at("runs"), 4);
}

std::vector<KnownEdge> known_edges() {
  const std::string free = "hand=false";
  const std::string held = "hand=true";
  const auto delay = [](const char* time) { return "host.delay.time=" + std::string(time); };
  const std::string damped = "wall.damping=1 N s/m";
  const std::string light = "device.dynamics.mass=10 g";
  return {{{free}, 1003.3},
          {{free, delay("0.5 ms")}, 668.9},
          {{free, delay("0.773 ms")}, 566.1},
          {{free, delay("1 ms")}, 502.1},
          {{free, delay("2 ms")}, 335.2},
          {{free, delay("3 ms")}, 251.8},
          {{free, delay("4 ms")}, 201.7},
          {{free, "host.pipeline_depth=1"}, 335.2},
          {{free, "wall.sides=both", delay("0.25 ms")}, 802.5},
          {{free, damped}, 1967},
          {{free, damped, delay("2 ms")}, 656},
          {{free, damped, delay("4 ms")}, 392},
          {{held}, 5610},
          {{held, delay("2 ms")}, 1899},
          {{held, delay("4 ms")}, 1167},
          {{free, light}, 1035},
          {{free, light, delay("2 ms")}, 351},
          {{free, light, delay("4 ms")}, 215.6}};
}
INSTANTIATE_TEST_SUITE_P(Of, KnownStability, ::testing::ValuesIn(known_edges()));

// With the delay that real bus and host times add up to.
TEST_F(LoopCommands, AWallsEdgeIsThatOfTheDelayOfItsParts) {
  const json j = stability({"hand=false", "fidelity.bus=loosely-timed",
                            "fidelity.host=loosely-timed", "host.sustained_rate=1 Mflop/s",
                            "device.daq.output_delay=500 us", "device.daq.sampling_delay=300 us"});
  const double delay_s = 1e-6 * j.at("delay_us").get<double>();
  EXPECT_GT(delay_s, 800e-6);
  EXPECT_NEAR(j.at("stiffness_max"), 1 / (1e-3 + delay_s), 0.02 / (1e-3 + delay_s));
  EXPECT_NEAR(j.at("stiffness_max"), j.at("stiffness_linear"),
              0.003 * j.at("stiffness_linear").get<double>());
}

// Abbott & Okamura 2005: K <= 2 f/D comes to rest between the steps; beyond it need not.
TEST_F(LoopCommands, AnEncoderAndFrictionComeToRestBelowTheirBound) {
  const std::vector<std::string> device = {"hand=false", "device.friction.force=0.04 N",
                                           "device.encoder.resolution=0.1 mm"};
  const json j = stability(device);
  EXPECT_NEAR(j.at("stiffness_encoder"), 800, 1e-6);
  EXPECT_GE(j.at("stiffness_max"), 800);
  // In a hand at rest, on both sides of 2 f/D = 160 N/m: what swings on does so within a step.
  for (const double stiffness : {80.0, 140.0, 320.0, 1280.0}) {
    const json loop =
        run({"hand=true", "device.friction.force=0.04 N", "device.encoder.resolution=0.5 mm",
             "device.dynamics.damping=0.5 N s/m", "wall.sides=one", "frames=2000",
             "probe.motion[0]={phase='press', to=['0 mm','0 mm','-5 mm'], duration='600 ms'}",
             "wall.stiffness=" + std::to_string(stiffness) + " N/m"})
            .at("loop")
            .at(0);
    EXPECT_TRUE(loop.at("oscillation_measured"));
    const json& swing = loop.at("oscillation");
    if (stiffness < 160) {
      EXPECT_TRUE(swing.is_null()) << stiffness << swing.dump();
      continue;
    }
    ASSERT_FALSE(swing.is_null()) << stiffness;
    EXPECT_GT(swing.at("amplitude_m"), 1e-6);
    EXPECT_LT(swing.at("amplitude_m"), 0.5e-3);
    EXPECT_GT(swing.at("frequency_hz"), 10);
  }
}

TEST_F(LoopCommands, ARunSaysWhereEnergyWentAndWhatLatencyCosts) {
  const json s = run({"host.delay.time=0.5 ms", "device.friction=true", "device.encoder=true"});
  const json& energy = s.at("loop").at(0).at("energy");
  EXPECT_LT(std::abs(energy.at("imbalance_rel").get<double>()), 1e-9);
  const json& in = energy.at("in_J");
  const json& lost = energy.at("lost_J");
  const double balance = in.at("motors").get<double>() + in.at("hand").get<double>() +
                         in.at("gravity").get<double>() - lost.at("device_damping").get<double>() -
                         lost.at("hand_damping").get<double>() - lost.at("friction").get<double>() -
                         energy.at("stored_J").get<double>();
  EXPECT_NEAR(balance, 0, 1e-15);
  double parts = 0;
  for (const auto& part : energy.at("of_motors_J").items()) parts += part.value().get<double>();
  EXPECT_NEAR(parts, in.at("motors").get<double>(), 1e-15);

  const json& stiffness = s.at("stiffness");
  EXPECT_NEAR(stiffness.at("delay_us"), 500, 1e-9);
  ASSERT_EQ(stiffness.at("parts").size(), 1U);
  EXPECT_EQ(stiffness.at("parts").at(0).at("phase"), "delay");
  EXPECT_NEAR(stiffness.at("stable_N_m").get<double>() +
                  stiffness.at("parts").at(0).at("cost_N_m").get<double>(),
              stiffness.at("without_delay_N_m").get<double>(), 1e-3);
}

TEST_F(LoopCommands, AnActivePortAndAGrowingSwingAreFlagged) {
  const json s = run({"wall.stiffness=1100 N/m"});
  EXPECT_EQ(s.at("verdict"), "held, with flags");
  EXPECT_THAT(s.at("stability").at("flags"), ::testing::Contains("active-port"));
  EXPECT_THAT(s.at("stability").at("flags"), ::testing::Contains("limit-cycle"));
  EXPECT_LT(s.at("loop").at(0).at("energy").at("port").at("least_J"), -1e-6);
  // Which part did it.
  EXPECT_THAT(s.at("loop").at(0).at("energy").at("fed_by"), ::testing::Contains("latency"));
  EXPECT_TRUE(run({"wall.stiffness=900 N/m"}).at("stability").at("flags").empty());
}

// As it is printed.
TEST_F(LoopCommands, ASofterWallIsTriedBeforeItIsNamed) {
  const json remedy = run({"wall.stiffness=1100 N/m", "hand=false"}).at("remedy");
  EXPECT_TRUE(remedy.at("works"));
  ASSERT_EQ(remedy.at("set").size(), 1U);
  const std::string setting = remedy.at("set").at(0);
  EXPECT_THAT(setting, ::testing::StartsWith("wall.stiffness="));
  EXPECT_TRUE(run({"hand=false", setting}).at("stability").at("flags").empty());
}

// What is found anew in a frame is not older than it.
TEST_F(LoopCommands, AFreshContactHasNoAge) {
  const std::vector<std::string> few = {"frames=400", "reference=false", "output.remedies=false",
                                        "output.deformation_every_frames=0", "contact.fresh=true"};
  const Ended ended = with("run", few, "thesis-refined.toml");
  ASSERT_EQ(ended.status, 0) << ended.err;
  int touching = 0;
  for (const std::string& line : lines(read(place_.path() / "out/frames.csv"))) {
    if (line.starts_with("frame")) continue;
    std::vector<std::string> fields;
    for (std::size_t from = 0; from < line.size();) {
      const std::size_t comma = std::min(line.find(',', from), line.size());
      fields.push_back(line.substr(from, comma - from));
      from = comma + 1;
    }
    EXPECT_EQ(fields.at(7), "0.000000");
    touching += fields.at(6) != "-1" ? 1 : 0;
  }
  EXPECT_GT(touching, 100);
}

// Friction stops a small swing and not a large one: the edge is that of every amplitude, and the
// scenario's own run is on its side.
TEST_F(LoopCommands, AnEdgeHoldsForEveryAmplitude) {
  const std::vector<std::string> touch = {"hand=false", "device.model=touch",
                                          "device.dynamics.mass=45 g", "host.delay.time=0.9 ms"};
  const json j = stability(touch);
  const double edge = j.at("stiffness_max");
  ASSERT_GT(j.at("edges").size(), 5U);
  std::vector<double> found;
  for (const json& e : j.at("edges")) {
    if (!e.at("stuck").get<bool>()) found.push_back(e.at("stiffness_max"));
  }
  EXPECT_EQ(edge, *std::ranges::min_element(found));
  EXPECT_TRUE(j.at("edges").back().at("push_N").is_null());
  EXPECT_TRUE(j.at("edges").front().at("stuck")) << "a tenth of a newton is friction's";
  EXPECT_GT(*std::ranges::max_element(found), 2 * edge);
  // The Touch gives 3.3 N; a trial begins with half as much again as the push.
  EXPECT_GT(j.at("beyond_device_N"), 3.3 / 1.5);
  EXPECT_LE(j.at("beyond_device_N"), 3.3);
  const auto limit_cycle = [&](double stiffness) {
    std::vector<std::string> settings = touch;
    settings.push_back("wall.stiffness=" + std::to_string(stiffness) + " N/m");
    const json flags = run(settings).at("stability").at("flags");
    return std::ranges::count(flags, json("limit-cycle")) > 0;
  };
  EXPECT_FALSE(limit_cycle(0.98 * edge));
  EXPECT_TRUE(limit_cycle(1.02 * edge));

  // A device without a limit has no last push, and this one's edge is still falling. The motion of
  // a probe that never comes to the wall is no edge: a wall of one side, since one of both sides
  // draws from afar too.
  const json strong =
      stability({"hand=false", "device.friction.force=50 mN", "wall.sides=one",
                 "probe.start=['0 mm','0 mm','90 mm']",
                 "probe.motion=[{phase='hold', to=['0 mm','0 mm','90 mm'], duration='1 s'}]"});
  EXPECT_TRUE(strong.at("beyond_device_N").is_null());
  EXPECT_TRUE(strong.at("falling"));
  for (const json& e : strong.at("edges")) EXPECT_FALSE(e.at("push_N").is_null());

  // A linear loop has one edge, whatever the push.
  const Ended text = hvp(place_.path(), {"stability", scenario("wall.toml").string(), "--set",
                                         "hand=false", "--quiet"});
  EXPECT_THAT(text.out, ::testing::Not(HasSubstr("pushed with")));
}

// A body too: its Young's modulus is what is varied.
TEST_F(LoopCommands, TheStiffestBodyIsFoundByItsRuns) {
  const Ended ended = with("stability", {"reference=false"}, "sphere-in-hand.toml");
  ASSERT_EQ(ended.status, 0) << ended.err;
  const json j = json::parse(ended.out);
  EXPECT_GT(j.at("stiffness_max"), 500);
  EXPECT_GT(j.at("unstable_from"), j.at("stiffness_max"));
  EXPECT_GT(j.at("young_modulus_Pa"), 10e3);
  EXPECT_NEAR(j.at("stiffness_linear"), 2722, 60);
}

TEST_F(LoopCommands, APushIsANumber) {
  for (const char* const push : {"nan", "inf", "0", "-1"}) {
    const Ended ended =
        hvp(place_.path(), {"stability", scenario("wall.toml").string(), "--push", push});
    EXPECT_EQ(ended.status, 2) << push;
    EXPECT_THAT(ended.err, HasSubstr("--push: expected a number from 0.001 to 1000, found "));
  }
}

TEST_F(LoopCommands, AReadyDeviceIsUnderWhatTheScenarioSays) {
  run({"device.model=omni"});
  std::string resolved = read(place_.path() / "out/scenario.resolved.toml");
  EXPECT_THAT(resolved, HasSubstr("[device.friction]\nforce = \"260 mN\""));
  EXPECT_THAT(resolved, HasSubstr("mass = \"100 g\"")) << "the scenario's own";
  run({"device.model=omni", "device.friction=false", "device.limits.force=2 N"});
  resolved = read(place_.path() / "out/scenario.resolved.toml");
  EXPECT_THAT(resolved, HasSubstr("# [device.friction] is not in this scenario"));
  EXPECT_THAT(resolved, HasSubstr("force = \"2 N\""));
  expect_refused({"device.model=omny"}, "did you mean \"omni\"?");
  write(place_.path() / "own.toml", "[dynamics]\nmass = \"-1 g\"\n");
  write(place_.path() / "s.toml", "base = \"" + scenario("wall.toml").string() +
                                      "\"\n[device]\nmodel = \"own.toml\"\n"
                                      "[device.dynamics]\ndamping = \"1 N s/m\"\n");
  write(place_.path() / "own.toml", "[friction]\nforce = \"-1 N\"\n");
  const Ended ended = hvp(place_.path(), {"run", "s.toml", "--out", "out"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, HasSubstr("own.toml:2: device.friction.force: out of range"));
}

// The mass of a model, which is at the tip, gives way to the inertia of joints.
TEST_F(LoopCommands, AMassFollowsThePoseWhereTheInertiaIsInTheJoints) {
  const std::vector<std::string> joints = {"device.model=premium-1.5",
                                           "device.kinematics.home=['0 mm', '0 mm', '-60 mm']",
                                           "device.dynamics.at=joints", "wall.stiffness=300 N/m"};
  const json loop = run(joints).at("loop").at(0);
  EXPECT_LT(std::abs(loop.at("energy").at("imbalance_rel").get<double>()), 1e-12);
  const Ended explained = with("explain", joints);
  ASSERT_EQ(explained.status, 0) << explained.err;
  EXPECT_THAT(explained.out, HasSubstr(" g along x, y and z"));
  expect_refused({"device.dynamics.at=joints"},
                 "device.dynamics.at=joints: \"joints\" needs a device that has some: expected "
                 "[device.kinematics] too, or \"tip\"");
  std::vector<std::string> both = joints;
  both.emplace_back("device.dynamics.mass=50 g");
  expect_refused(both, "belongs to at = \"tip\" only, found \"joints\"");
}

// A soft structure hides the hand's damping from the wall: runs and eigenvalues agree on the edge.
TEST_F(LoopCommands, AStructureIsInEigenvaluesRunsAndLedger) {
  const std::vector<std::string> soft = {"hand=true", "device.structure.frequency=60 Hz"};
  const json j = stability(soft);
  const double linear = j.at("stiffness_linear");
  EXPECT_LT(linear, 5200) << "without it 5610";
  EXPECT_NEAR(j.at("stiffness_max"), linear, 0.005 * linear);
  std::vector<std::string> softer = soft;
  softer.emplace_back("wall.stiffness=500 N/m");
  const json loop = run(softer).at("loop").at(0);
  EXPECT_LT(std::abs(loop.at("energy").at("imbalance_rel").get<double>()), 1e-12);
  EXPECT_THAT(read(place_.path() / "out/frames.csv"), HasSubstr("handle_z_m"));
  expect_refused({"device.dynamics=false", "device.structure=true"},
                 "device.structure=true: only a device with mass can be moved by a force");
}

TEST_F(LoopCommands, WhatCannotBeIsRefusedInALine) {
  expect_refused({"device.dynamics.mass=0 g"}, "device.dynamics.mass=0 g: out of range");
  expect_refused({"device.dynamics.mass=-1 kg"}, "out of range");
  expect_refused({"device.dynamics=false", "hand=true"},
                 "hand=true: a hand moves a device that has mass");
  expect_refused({"device.motor=true", "device.amplifier=true", "device.dac.bits=0"},
                 "device.dac.bits=0: out of range");
  expect_refused({"device.dac=true"}, "expected [device.amplifier] too");
  expect_refused({"object.mesh.nodes=300"}, "not beside [wall]");
  expect_refused({"solver.method=cg"}, "not beside [wall]");
  expect_refused({"device.kinematics.kind=serial-arm", "probe.motion[0].phase=slide",
                  "probe.motion[0].to=['0 mm','0 mm','1 m']"},
                 "out of reach");
  expect_refused({"wall.normal=[0, 0, 0]"}, "has no length");
  expect_refused({"device.encoder.at=joints"}, "expected [device.kinematics] too");
  expect_refused({"device.dynamics=false", "hand=false"}, "a device without mass has no stability",
                 "stability");
  const Ended body = with("stability", {}, "thesis.toml");
  EXPECT_EQ(body.status, 2);
  EXPECT_EQ(lines(body.err).size(), 1U) << body.err;
}

}  // namespace
}  // namespace hvp::cli::closed_loop_test
