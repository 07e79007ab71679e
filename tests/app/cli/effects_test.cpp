// An effect is declared once: whoever lists effects lists the same.
#include "models/config/effects.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/scene/scenario.h"
#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

namespace hvp::cli {
namespace {

using config::Effect;
using config::Need;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

std::vector<Effect> declared() { return config::survey_effects(app::Scenario{}).effects(); }

// What has to be set for an effect to be there, and what it needs.
std::vector<std::string> switch_on(const Effect& effect) {
  if (effect.path == "transfer.dma") return {"transfer.method=dma"};
  std::vector<std::string> settings = {
      effect.path == "fault" ? "fault[0]={kind='lost-interrupt', frame=1}" : effect.path + "=true"};
  for (const Need& need : effect.needs) {
    settings.push_back(std::string(need.key) + '=' + std::string(need.values.front()));
  }
  return settings;
}

// A small scene with a command and its settings.
class Effects : public ::testing::Test {
 protected:
  Effects() { write(place_.path() / "s.toml", kSmallScene); }

  Ended with(const std::string& command, const std::vector<std::string>& settings) {
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

// One effect a process.
class OneEffect : public Effects, public ::testing::WithParamInterface<std::size_t> {
 protected:
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

INSTANTIATE_TEST_SUITE_P(Of, OneEffect, ::testing::Range(std::size_t{0}, declared().size()),
                         [](const auto& of) {
                           std::string name = declared().at(of.param).path;
                           std::ranges::replace(name, '.', '_');
                           return name;
                         });

}  // namespace
}  // namespace hvp::cli
