#include "models/config/figures.h"

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/results/figures.h"
#include "app/results/outcome.h"

namespace hvp::results::figures_test {
namespace {

using ::testing::ElementsAre;

struct Spring {
  double force = 0;
  std::int64_t turns = 0;

  void report(config::Figures& f) const {
    f.quantity("force_N", force, "N", "how hard");
    f.count("turns", turns, "how many");
  }
};

// Has one of everything that may be missing.
struct Machine {
  std::optional<Spring> main;
  std::optional<Spring> spare;
  std::optional<double> wear;
  std::vector<Spring> others;
  struct Named {
    std::string_view name;
    std::int64_t count = 0;
    void report(config::Figures& f) const { f.count("count", count, "how often"); }
  };
  std::vector<Named> errors;
  bool noisy = false;

  void report(config::Figures& f) const {
    f.table("label", "on it", [&] { f.text("maker", "nobody", "who made it"); });
    f.time("time_us", 651'340'000, "how long");
    f.ratio("wear_rel", wear, "of new");
    f.table_or_null("main", "the spring", main);
    f.table_if_present("spare", "another", spare);
    f.list("others", "the rest", others);
    f.tables("errors", "by name", errors, [](const Named& e) { return e.name; });
    f.when(noisy, [&] { f.truth("noisy", noisy, "can be heard"); });
    f.table("label", {}, [&] { f.text("year", "1999", "when"); });
  }
};

std::vector<std::string> keys(const std::vector<ListedFigure>& figures) {
  std::vector<std::string> keys;
  for (const ListedFigure& figure : figures) keys.push_back(figure.key);
  return keys;
}

TEST(Figures, WhatIsMissingIsNullOrLeftOut) {
  EXPECT_EQ(figures_json(Machine{}).dump(),
            R"({"label":{"maker":"nobody","year":"1999"},"time_us":651.34,"wear_rel":null,)"
            R"("main":null,"others":[],"errors":{}})");
}

TEST(Figures, AreWrittenInTheOrderOfTheirDeclaration) {
  const Machine machine{.main = Spring{1.5, 2},
                        .spare = Spring{0.5, 3},
                        .wear = 0.25,
                        .others = {{1, 1}, {2, 2}},
                        .errors = {{"lost", 4}},
                        .noisy = true};
  EXPECT_EQ(figures_json(machine).dump(),
            R"({"label":{"maker":"nobody","year":"1999"},"time_us":651.34,"wear_rel":0.25,)"
            R"("main":{"force_N":1.5,"turns":2},)"
            R"("spare":{"force_N":0.5,"turns":3},)"
            R"("others":[{"force_N":1.0,"turns":1},{"force_N":2.0,"turns":2}],)"
            R"("errors":{"lost":{"count":4}},"noisy":true})");
}

TEST(Figures, ADeclarationHasEverythingThatMayBeMissing) {
  EXPECT_THAT(keys(declared_figures<Machine>()),
              ElementsAre("label.*", "label.maker", "time_us", "wear_rel", "main.*", "main.force_N",
                          "main.turns", "spare.*", "spare.force_N", "spare.turns", "others[].*",
                          "others[].force_N", "others[].turns", "errors.*", "errors.<item>.count",
                          "noisy", "label.year"));
}

TEST(Figures, ARunIsAListOfNamesUnitsAndValues) {
  const Machine machine{.main = Spring{1.5, 2},
                        .spare = {},
                        .wear = {},
                        .others = {{1, 1}},
                        .errors = {{"lost", 4}},
                        .noisy = false};
  const std::vector<ListedFigure> figures = figures_of(machine);
  EXPECT_THAT(keys(figures), ElementsAre("label.maker", "time_us", "wear_rel", "main.force_N",
                                         "main.turns", "errors.lost.count", "label.year"));
  EXPECT_EQ(figures[1].unit, "µs");
  EXPECT_EQ(figures[1].value, config::FigureValue(651.34));
  EXPECT_EQ(figures[2].value, config::FigureValue());
  EXPECT_EQ(figures[3].unit, "N");
  EXPECT_EQ(figures[3].value, config::FigureValue(1.5));
  EXPECT_EQ(figures[3].help, "how hard");
  EXPECT_EQ(figures[5].value, config::FigureValue(std::int64_t{4}));
}

// What a key ends in, and the unit that this says.
std::optional<std::string_view> unit_in(std::string_view key) {
  static const std::map<std::string_view, std::string_view> kUnits = {
      {"us", "µs"}, {"N", "N"}, {"m", "m"}, {"deg", "°"}, {"rel", ""}, {"share", ""}};
  for (const auto& [ending, unit] : {std::pair<std::string_view, std::string_view>{"_N_m", "N/m"},
                                     {"_N_s_m", "N·s/m"},
                                     {"_m_s", "m/s"}}) {
    if (key.ends_with(ending)) return unit;
  }
  const auto found = kUnits.find(key.substr(key.find_last_of("._") + 1));
  return found == kUnits.end() ? std::nullopt : std::optional(found->second);
}

TEST(Figures, OfARunHaveDistinctKeysAndTheUnitThatTheKeySays) {
  std::set<std::string> seen;
  for (const ListedFigure& figure : declared_figures<Outcome>()) {
    EXPECT_TRUE(seen.insert(figure.key).second) << figure.key << " stands twice";
    EXPECT_FALSE(figure.help.empty()) << figure.key;
    if (const auto unit = unit_in(figure.key)) {
      EXPECT_EQ(figure.unit, *unit) << figure.key;
    }
    if (figure.unit == config::kMicroseconds) {
      EXPECT_EQ(unit_in(figure.key), config::kMicroseconds) << figure.key;
    }
  }
  EXPECT_TRUE(seen.contains("deadline.worst_us"));
  EXPECT_TRUE(seen.contains("bus.pcie.utilisation.to_host.share"));
  EXPECT_TRUE(seen.contains("accelerator.phases[].closed_form_cycles"));
}

TEST(Figures, ARunsListIsWhatItsSummaryHas) {
  Outcome outcome;
  outcome.force.emplace();
  outcome.bus.link.emplace();
  const nlohmann::ordered_json summary = figures_json(outcome);
  for (const ListedFigure& figure : figures_of(outcome)) {
    std::string pointer = "/" + figure.key;
    for (char& c : pointer) c = c == '.' ? '/' : c;
    ASSERT_TRUE(summary.contains(nlohmann::ordered_json::json_pointer(pointer))) << figure.key;
  }
}

}  // namespace
}  // namespace hvp::results::figures_test
