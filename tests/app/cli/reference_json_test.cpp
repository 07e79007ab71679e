#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// `hvp reference --json` against what the program takes and writes.
namespace hvp::cli::reference_json_test {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::IsEmpty;

json reference() {
  const ScratchDirectory place;
  const Ended ended = hvp(place.path(), {"reference", "--json"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  return json::parse(ended.out);
}

std::set<std::string> keys_of(const json& figures) {
  std::set<std::string> keys;
  for (const json& figure : figures) keys.insert(figure.at("key").get<std::string>());
  return keys;
}

// "a.b", "a[].b" of an object's values; a list of numbers or texts is one value.
void flatten(const json& value, const std::string& path, std::set<std::string>& keys) {
  const bool tables = value.is_array() && !value.empty() && value.front().is_object();
  if (tables) {
    for (const json& item : value) flatten(item, path + "[]", keys);
  } else if (value.is_object()) {
    for (const auto& [name, member] : value.items()) {
      flatten(member, path.empty() ? name : path + '.' + name, keys);
    }
  } else {
    keys.insert(path);
  }
}

// "bus.<item>.share" stands for "bus.b.share".
bool stands_for(const std::string& declared, const std::string& key) {
  const std::size_t item = declared.find("<item>");
  if (item == std::string::npos) return declared == key;
  const std::string behind = declared.substr(item + 6);
  return key.starts_with(declared.substr(0, item)) && key.ends_with(behind) &&
         key.size() > item + behind.size();
}

// Those of an output that are not declared. A null or an empty list may stand for a whole table.
std::set<std::string> undeclared(const json& output, const std::set<std::string>& declared) {
  std::set<std::string> keys;
  flatten(output, "", keys);
  std::erase_if(keys, [&](const std::string& key) {
    return std::ranges::any_of(declared, [&](const std::string& d) {
      return stands_for(d, key) || d.starts_with(key + '.') || d.starts_with(key + "[]");
    });
  });
  return keys;
}

TEST(ReferenceJson, HasAsManyKeysAsThePage) {
  const ScratchDirectory place;
  std::size_t rows = 0;
  for (const std::string& line : lines(hvp(place.path(), {"reference"}).out)) {
    if (line.starts_with("| `")) ++rows;
  }
  EXPECT_EQ(reference().at("keys").size(), rows);
}

TEST(ReferenceJson, TellsAKeysUnitRangeAndDefault) {
  const json all = reference();
  const auto key = [&all](const std::string& path) {
    for (const json& one : all.at("keys")) {
      if (one.at("path") == path) return one;
    }
    return json();
  };
  const json period = key("budget.period");
  EXPECT_EQ(period.at("type"), "quantity");
  EXPECT_EQ(period.at("dimension"), "time");
  EXPECT_EQ(period.at("unit"), "s");
  EXPECT_EQ(period.at("default"), "2 ms");
  EXPECT_EQ(period.at("default_si"), 2e-3);
  EXPECT_THAT(period.at("units"), Contains("us"));
  EXPECT_EQ(key("frames").at("range"),
            (json{{"min", 1}, {"max", 100'000'000}, {"min_open", false}, {"max_open", false}}));
  EXPECT_THAT(key("fidelity.bus").at("choices"), Contains("approximately-timed"));
  EXPECT_TRUE(key("budget.period").at("effect").is_null());
  EXPECT_EQ(key("bus.traffic.period").at("effect"), "bus.traffic");
  EXPECT_EQ(key("fault[].kind").at("effect"), "fault");
  EXPECT_TRUE(key("fault[].kind").at("list_item").get<bool>());
}

// What is said to be a default is one: stated, it changes nothing.
TEST(ReferenceJson, StatedDefaultsChangeNothing) {
  const ScratchDirectory place;
  write(place.path() / "s.toml",
        "[[object.anchor]]\n[probe]\nstart = ['0 mm', '0 mm', '60 mm']\n[[probe.motion]]\n"
        "phase = 'hold'\nto = ['0 mm', '0 mm', '60 mm']\nduration = '1 s'\n");
  std::vector<std::string> overrides;
  const json all = reference();
  for (const json& key : all.at("keys")) {
    const json conditions = key.value("only_with", json::array());
    const bool sometimes = std::ranges::any_of(
        conditions, [](const json& condition) { return condition.contains("key"); });
    const bool item = key.at("list_item").get<bool>();
    if (sometimes || item || !key.at("effect").is_null() || key.at("default").is_null()) continue;
    // An empty file or text is none.
    if (key.at("default") == "") continue;
    overrides.push_back(key.at("path").get<std::string>() + '=' + key.at("default").dump());
  }
  ASSERT_GT(overrides.size(), 60U);
  const Ended ended = hvp_reading("[]\n" + json(overrides).dump() + '\n', place.path(),
                                  {"resolve", "s.toml", "--each"});
  const std::vector<std::string> answers = lines(ended.out);
  ASSERT_EQ(answers.size(), 2U) << ended.err;
  EXPECT_THAT(answers[0], ::testing::StartsWith("{\"scenario\""));
  EXPECT_EQ(answers[1], answers[0]);
}

TEST(ReferenceJson, DeclaresEveryFigureOfARun) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", kSmallScene);
  ASSERT_LE(hvp(place.path(), {"run", "s.toml", "--out", "out"}).status, 1);
  const json all = reference();
  const json summary = json::parse(read(place.path() / "out/summary.json"));
  EXPECT_THAT(undeclared(summary, keys_of(all.at("figures"))), IsEmpty());
  const json performance = json::parse(read(place.path() / "out/performance.json"));
  std::set<std::string> measured;
  flatten(performance, "", measured);
  EXPECT_EQ(measured, keys_of(all.at("performance_figures")));
  std::string columns;
  for (const json& column : all.at("columns")) {
    columns += (columns.empty() ? "" : ",") + column.at("name").get<std::string>();
  }
  EXPECT_EQ(lines(read(place.path() / "out/frames.csv")).front(), columns);
}

TEST(ReferenceJson, DeclaresEveryFigureOfADevice) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", kSmallScene);
  const std::set<std::string> declared = keys_of(reference().at("device_figures"));
  for (const char* setting : {"accelerator.several=true", "accelerator.partitions=64"}) {
    const Ended ended = hvp(place.path(), {"device", "s.toml", "--json", "--set", setting});
    EXPECT_THAT(undeclared(json::parse(ended.out), declared), IsEmpty());
  }
  EXPECT_THAT(declared, Contains("largest_mesh.mesh_nodes"));
}

TEST(ReferenceJson, TellsOfEveryFlagWhatItMeansAndWhatHelps) {
  const json flags = reference().at("flags");
  for (const json& flag : flags) {
    EXPECT_NE(flag.at("name"), "");
    EXPECT_NE(flag.at("meaning"), "") << flag;
    EXPECT_NE(flag.at("remedy"), "") << flag;
  }
}

}  // namespace
}  // namespace hvp::cli::reference_json_test
