#include "app/scenario/reference.h"

#include <algorithm>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/app/scenario/toy_scene.h"

namespace hvp::scenario::reference_test {
namespace {

TEST(Outline, ListsTablesInOrderWithEffectsAndLists) {
  const Outline outline = describe(toy::Scene{});
  std::vector<std::string> paths;
  for (const OutlineTable& table : outline) paths.push_back(table.path);
  EXPECT_EQ(paths, (std::vector<std::string>{"", "budget", "solver", "host", "host.jitter",
                                             "object", "contacts", "contacts.shape"}));
  EXPECT_EQ(outline[4].kind, OutlineTable::Kind::effect);
  EXPECT_EQ(outline[6].kind, OutlineTable::Kind::list);
  EXPECT_EQ(outline[3].rows.size(), 1U) << "a row after a sub-table belongs to the outer table";
}

TEST(Outline, ChangesNothing) {
  toy::Scene scene;
  scene.contacts.resize(3);
  scene.contacts[2].depth = 1.0;
  toy::Scene visited = scene;
  Describer describer;
  visited.declare(describer);
  EXPECT_EQ(visited, scene);
}

TEST(ReferencePage, HasARowForEveryParameter) {
  const std::string page = reference_page(toy::Scene{});
  const auto has = [&page](const char* text) {
    EXPECT_NE(page.find(text), std::string::npos) << text << "\n" << page;
  };
  has("| `title` | text |  | required | one line |  |\n");
  has("| `period` | time | more than 0 s | `\"2 ms\"` | the servo loop's period | thesis section "
      "6.2 "
      "|\n");
  has("| `method` | one of | \"cg\" or \"pcg\" | `\"pcg\"` |");
  has("| `iterations` | whole number | from 1 to 500 | `60` |");
  has("| `tolerance` | number | at least 0 and less than 1 | `0.0` |");
  has("## `[host.jitter]`\n\n**Effect**");
  has("## `[[contacts]]`\n\n**List**");
  has("assumed \\| not measured");
  has("| `seed` | whole number |  | `1` |");
  has("| time | `s`, `ms`, `us`, `ns`, `ps`, `min` | `\"2 ms\"` |");
}

TEST(ReferencePage, IsWellFormed) {
  std::istringstream page(reference_page(toy::Scene{}));
  for (std::string line; std::getline(page, line);) {
    if (!line.starts_with('|')) continue;
    std::size_t bars = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (line[i] == '|' && (i == 0 || line[i - 1] != '\\')) ++bars;
    }
    EXPECT_TRUE(bars == 7 || bars == 4) << line;
  }
}

}  // namespace
}  // namespace hvp::scenario::reference_test
