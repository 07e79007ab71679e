// An effect is declared once: whoever lists effects lists the same.
#include "models/config/effects.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/devices/devices.h"
#include "app/scenario/reader.h"
#include "app/scene/scene.h"
#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"
#include "tests/vp/child_output.h"
#include "vp/platform.h"

namespace hvp::cli::effects_test {
namespace {

using config::Effect;
using config::Need;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

std::vector<Effect> declared() { return config::survey_effects(app::Scenario{}).effects(); }

// What an effect needs.
std::vector<std::string> needs_of(const Effect& effect) {
  std::vector<std::string> settings;
  for (const Need& need : effect.needs) {
    if (need.values.front() != config::kPresent) {
      settings.push_back(std::string(need.key) + '=' + std::string(need.values.front()));
      continue;
    }
    // With what that effect needs itself.
    settings.push_back(std::string(need.key) + "=true");
    for (const Effect& other : declared()) {
      if (other.path != need.key) continue;
      const std::vector<std::string> more = needs_of(other);
      settings.insert(settings.end(), more.begin(), more.end());
    }
  }
  return settings;
}

// What has to be set for an effect to be there, and what it needs.
std::vector<std::string> switch_on(const Effect& effect) {
  if (effect.path == "transfer.dma") return {"transfer.method=dma"};
  std::vector<std::string> settings = needs_of(effect);
  std::string on = effect.path + "=true";
  if (effect.path == "fault") on = "fault[0]={kind='lost-interrupt', frame=1}";
  // By itself it renews nothing.
  if (effect.path == "object.model.matrix") on = "object.model.matrix.renew_every=5";
  settings.insert(settings.begin(), on);
  return settings;
}

// A wall has no body beside it, and --set takes none out.
constexpr const char* kWallScene = R"(
frames = 20
[wall]
[probe]
start = ["0 mm", "0 mm", "1 mm"]
[[probe.motion]]
phase = "press"
to = ["0 mm", "0 mm", "-1 mm"]
duration = "20 ms"
)";
const char* scene_for(const std::vector<std::string>& settings) {
  return std::ranges::count(settings, "wall=true") > 0 ? kWallScene : kSmallScene;
}

// A small scene with a command and its settings.
class Effects : public ::testing::Test {
 protected:
  Ended with(const std::string& command, const std::vector<std::string>& settings) {
    write(place_.path() / "s.toml", scene_for(settings));
    std::vector<std::string> arguments = {command, "s.toml"};
    for (const std::string& setting : settings) {
      arguments.emplace_back("--set");
      arguments.push_back(setting);
    }
    if (command == "run") arguments.insert(arguments.end(), {"--out", "out"});
    return hvp(place_.path(), arguments);
  }
  json summary() { return json::parse(read(place_.path() / "out/summary.json")); }

  ScratchDirectory place_;
};

// The lines of a report's section, without its heading.
std::vector<std::string> section(const std::string& report, const std::string& heading) {
  std::vector<std::string> found;
  bool inside = false;
  for (const std::string& line : lines(report)) {
    if (inside && line.empty()) break;
    if (inside) found.push_back(line);
    inside = inside || line == heading;
  }
  return found;
}

TEST_F(Effects, AreExplainedAndInTheReferenceInTheOrderOfTheirDeclaration) {
  const std::vector<std::string> explained = section(with("explain", {}).out, "Effects");
  const std::vector<Effect> effects = declared();
  ASSERT_EQ(explained.size(), effects.size());
  const std::string reference = hvp(place_.path(), {"reference"}).out;
  std::size_t at = 0;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    EXPECT_THAT(explained[i], ::testing::StartsWith("  " + effects[i].path + " "));
    EXPECT_THAT(explained[i], HasSubstr(effects[i].cost));
    EXPECT_NE(effects[i].cost, "") << effects[i].path;
    const std::size_t heading = reference.find('[' + effects[i].path + "]", at);
    ASSERT_NE(heading, std::string::npos) << effects[i].path;
    at = heading;
    EXPECT_THAT(reference.substr(at, 1500), HasSubstr("Adds: " + effects[i].cost));
  }
  // None is an effect in the reference alone.
  const auto count = [&reference](const std::string& text) {
    std::size_t found = 0;
    for (auto p = reference.find(text); p != std::string::npos; p = reference.find(text, p + 1)) {
      ++found;
    }
    return found;
  };
  EXPECT_EQ(count("\nAdds: "), effects.size());
  EXPECT_EQ(count("**Effect**"), effects.size() - 1);  // [[fault]] is a list
}

#ifdef HVP_HAS_RTL
constexpr bool kHasRtl = true;
#else
constexpr bool kHasRtl = false;
#endif

// One effect a process.
class OneEffect : public Effects, public ::testing::WithParamInterface<std::size_t> {
 protected:
  void SetUp() override {
    if (!kHasRtl && effect().path == "output.engine_port") {
      GTEST_SKIP() << "this build has no engine in SystemVerilog";
    }
  }
  Effect effect() const { return declared().at(GetParam()); }
};

TEST_P(OneEffect, IsInTheRunThatAsksForItWithWhatItNeeds) {
  const Ended ended = with("run", switch_on(effect()));
  ASSERT_LE(ended.status, 1) << ended.err;
  EXPECT_THAT(summary().at("effects"), ::testing::Contains(effect().path));
  const auto in_run = summary().at("effects").get<std::vector<std::string>>();
  const Ended explained = with("explain", switch_on(effect()));
  for (const std::string& line : section(explained.out, "Effects")) {
    const std::string path = line.substr(2, line.find(' ', 2) - 2);
    const bool built = std::ranges::find(in_run, path) != in_run.end();
    EXPECT_THAT(line, HasSubstr(built ? " built " : " absent ")) << line;
  }
}

// Every other value of a key that it needs is refused, by the effect's name.
TEST_P(OneEffect, IsRefusedWithoutWhatItNeeds) {
  const std::vector<Effect> all = declared();
  for (const Need& need : effect().needs) {
    const std::string key(need.key);
    for (const char* other : {"untimed", "cg", "none", "polling", "bursts", "dma", "1"}) {
      std::vector<std::string> settings = switch_on(effect());
      settings.push_back(key + '=' + other);
      const Ended ended = with("run", settings);
      const bool wanted = std::ranges::find(need.values, other) != need.values.end();
      if (wanted) continue;
      EXPECT_EQ(ended.status, 2) << key << " = " << other << ": " << ended.out;
      EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
    }
  }
}

TEST_F(Effects, ANeedIsNamedByTheEffectThatHasIt) {
  const Ended ended = with("run", {"bus.posted_writes=true", "fidelity.bus=untimed"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err,
              HasSubstr("bus.posted_writes=true: a bus that takes no time posts nothing: "
                        "expected fidelity.bus = \"loosely-timed\" or "
                        "\"approximately-timed\", found \"untimed\""));
}

// SystemC modules and processes.
struct Parts {
  std::vector<std::string> modules;
  int processes = 0;
};

// Of the small scene without an effect.
const Parts kBase = {{"bus", "accelerator", "daq", "access", "servo", "collision"}, 3};

// What an effect adds to the parts that there are without it: an effect without a line here fails.
// Nothing: it is arithmetic of parts that are there anyway.
const Parts kNothing;
const std::map<std::string, Parts> kAdded = {
    {"wall", kNothing},
    {"object.model", kNothing},
    {"object.model.matrix", kNothing},
    {"loads.gravity", kNothing},
    {"dynamics", kNothing},
    {"refinement", kNothing},
    {"accelerator.several", kNothing},
    {"bus.protocol", kNothing},
    {"bus.traffic", {{"traffic"}, 1}},
    {"bus.graphics_traffic", {{"graphics"}, 1}},
    {"bus.pcie", {{"bridge", "pcie", "pcie.down", "pcie.up"}, 4}},
    {"bus.pcie.root_complex_latencies", kNothing},
    {"bus.read_latencies", kNothing},
    {"bus.posted_writes", {{}, 2}},
    {"transfer.dma", {{"accelerator.dma", "memory"}, 1}},
    {"host.jitter", kNothing},
    {"host.wake_up", kNothing},
    {"host.interrupt_latencies", kNothing},
    {"host.gpu", kNothing},
    {"host.threads", kNothing},
    {"host.gpu.latencies", kNothing},
    {"host.delay", kNothing},
    {"host.virtual_coupling", kNothing},
    {"host.passivity", kNothing},
    {"guest", kNothing},
    {"function", kNothing},
    {"contact.fresh", kNothing},
    {"hand", kNothing},
    {"device.encoder", kNothing},
    {"device.dynamics", kNothing},
    {"device.structure", kNothing},
    {"device.friction", kNothing},
    {"device.gravity", kNothing},
    {"device.kinematics", kNothing},
    {"device.dac", kNothing},
    {"device.adc", kNothing},
    {"device.amplifier", kNothing},
    {"device.motor", kNothing},
    {"device.limits", kNothing},
    {"reference", kNothing},
    {"spectrum", kNothing},
    {"fault", kNothing},
    {"output.waveform", {{"waveform"}, 2}},
    {"output.engine_port", kNothing},
};

// What the platform of the small scene consists of, without its [reference] and with these
// settings, in a process of its own. One that is refused throws.
Parts built(const std::vector<std::string>& settings) {
  const std::string text = test::output_of_child([&settings](std::string& told) {
    const ScratchDirectory place;
    const bool wall = scene_for(settings) == kWallScene;
    std::vector<std::string> overrides;
    if (!wall) overrides.emplace_back("reference=false");
    overrides.insert(overrides.end(), settings.begin(), settings.end());
    try {
      const auto document =
          scenario::Document::parse(scene_for(settings), place.path() / "s.toml", overrides);
      app::Scenario scenario;
      scenario::read(document, scenario);
      app::Scene scene(scenario, devices::find(document, scenario.accelerator));
      std::optional<vp::SoftBody> soft;
      if (!wall) soft.emplace(vp::SoftBody{scene.body(), scene.computation(), scene.contacts()});
      const vp::Platform platform(app::platform_settings(scene, place.path() / "engine"), soft,
                                  nullptr);
      told = std::to_string(vp::Platform::processes());
      for (const std::string& module : vp::Platform::modules()) told += '\n' + module;
    } catch (const std::exception& e) {
      told = e.what();
    }
  });
  Parts parts;
  parts.modules = lines(text);
  parts.processes = std::stoi(parts.modules.at(0));
  parts.modules.erase(parts.modules.begin());
  return parts;
}

// Both taken away from what there is with an effect leaves what there is without it.
Parts without(Parts parts, const Parts& added) {
  for (const std::string& module : added.modules) {
    const auto found = std::ranges::find(parts.modules, module);
    if (found == parts.modules.end()) {
      parts.modules.push_back("no " + module);
    } else {
      parts.modules.erase(found);
    }
  }
  parts.processes -= added.processes;
  return parts;
}

void expect_equal(const Parts& found, const Parts& expected) {
  EXPECT_EQ(found.modules, expected.modules);
  EXPECT_EQ(found.processes, expected.processes);
}

// With all that it needs, and with the effect that it belongs to.
std::vector<std::string> switch_off(const Effect& effect) {
  std::vector<std::string> settings =
      effect.path == "transfer.dma" ? std::vector<std::string>{} : needs_of(effect);
  for (const Effect& other : declared()) {
    if (effect.path.starts_with(other.path + '.')) settings.push_back(other.path + "=true");
  }
  return settings;
}

TEST_P(OneEffect, BuildsWhatItsLineSaysAndNothingElse) {
  ASSERT_TRUE(kAdded.contains(effect().path))
      << "say in kAdded what is built for " << effect().path;
  if (effect().path == "wall") {
    // It stands in the place of what it takes away.
    expect_equal(built({"wall=true"}), {{"bus", "daq", "access", "servo"}, 1});
    return;
  }
  expect_equal(without(built(switch_on(effect())), kAdded.at(effect().path)),
               built(switch_off(effect())));
}

TEST(PartsOfEffects, AreThoseOfDeclaredEffectsOnly) {
  for (const auto& added : kAdded) {
    const std::string& path = added.first;
    EXPECT_TRUE(std::ranges::any_of(declared(), [&](const Effect& e) { return e.path == path; }))
        << path;
  }
}

TEST(PartsOfEffects, WithoutAnyThereIsTheBaseAlone) { expect_equal(built({}), kBase); }

// A message is a write to memory: the board is a master for it, though it moves no data.
TEST(PartsOfEffects, AMessageAloneTakesAMasterAndAMemory) {
  expect_equal(without(built({"transfer.method=programmed-io", "transfer.notification=msi"}),
                       {{"accelerator.dma", "memory"}, 1}),
               kBase);
}

INSTANTIATE_TEST_SUITE_P(Of, OneEffect, ::testing::Range(std::size_t{0}, declared().size()),
                         [](const auto& of) {
                           std::string name = declared().at(of.param).path;
                           std::ranges::replace(name, '.', '_');
                           return name;
                         });

}  // namespace
}  // namespace hvp::cli::effects_test
