#include "app/scenario/reference.h"

#include <array>
#include <string_view>

#include <fmt/format.h>

#include "app/scenario/message.h"
#include "app/scenario/quantity.h"

namespace hvp::scenario {
namespace {

std::string cell(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '|') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result;
}

std::string code(std::string_view text) {
  return text.empty() ? "" : fmt::format("`{}`", cell(text));
}

// "only with `shape` = "sphere": "
std::string only_with(const std::string& condition) {
  return condition.empty() ? "" : fmt::format("{}: ", cell(condition));
}

std::string sentence(const OutlineTable& table) {
  std::string text;
  if (table.kind == OutlineTable::Kind::effect) {
    text = "**Effect**: simulated only where the scenario has this table. ";
  } else if (table.kind == OutlineTable::Kind::list) {
    text = "**List**: one table an item. ";
  }
  if (table.required) text += "Required. ";
  text += only_with(table.condition);
  text += cell(table.help);
  if (!table.source.empty()) text += fmt::format(" ({})", cell(table.source));
  if (!table.cost.empty()) text += fmt::format("\n\nAdds: {}.", cell(table.cost));
  if (!table.needs.empty()) {
    std::vector<std::string> needs;
    for (const config::Need& need : table.needs) {
      needs.push_back(need.values.front() == config::kPresent
                          ? fmt::format("`[{}]`", need.key)
                          : fmt::format("`{}` = {}", need.key,
                                        alternatives({need.values.begin(), need.values.end()})));
    }
    text += fmt::format("\n\nNeeds: {}.", fmt::join(needs, "; "));
  }
  return text;
}

std::string section(const OutlineTable& table) {
  std::string text;
  if (!table.path.empty()) {
    text = table.kind == OutlineTable::Kind::list ? fmt::format("\n## `[[{}]]`\n", table.path)
                                                  : fmt::format("\n## `[{}]`\n", table.path);
    text += fmt::format("\n{}\n", sentence(table));
  }
  if (table.rows.empty()) return text;
  text +=
      "\n| key | type | range | default | what it is | source of the default |\n"
      "|---|---|---|---|---|---|\n";
  for (const OutlineRow& row : table.rows) {
    const std::string fallback = row.required ? "required" : code(row.fallback);
    text += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", row.name, cell(row.type),
                        cell(row.range), fallback, only_with(row.condition) + cell(row.help),
                        cell(row.source));
  }
  return text;
}

std::string unit_section() {
  std::string text =
      "\n## Units\n\nA quantity is a text of a number and a unit; a number alone is refused.\n"
      "\n| dimension | units | for example |\n|---|---|---|\n";
  for (const DimensionUnits& entry : all_dimensions()) {
    if (entry.units.empty()) continue;
    std::string units;
    for (const std::string_view unit : units_of(entry.dimension)) {
      units += fmt::format("{}`{}`", units.empty() ? "" : ", ", unit);
    }
    text += fmt::format("| {} | {} | `\"{}\"` |\n", entry.name.substr(entry.name.find(' ') + 1),
                        units, entry.example);
  }
  return text;
}

}  // namespace

std::string reference_tables(const Outline& outline) {
  std::string text;
  for (const OutlineTable& table : outline) text += section(table);
  return text;
}

std::string reference_page(const Outline& outline) {
  const std::string text =
      "# Scenario reference\n\n"
      "Written from the declarations of the parts; do not edit.\n"
      "A table that is left out has its defaults, except an effect, which is then not simulated.\n"
      "\n"
      "`base = \"other.toml\"` at the top names a scenario of which this one states what differs, "
      "by a path\nfrom its own folder. A list takes the place of the base's, and `NAME = false` "
      "takes an effect of the\nbase out.\n"
      "\n"
      "`include = \"fitted.toml\"` or `include = [\"a.toml\", \"b.toml\"]` at the top names files "
      "of some of these\nkeys, likewise. What the scenario states itself counts most, then the "
      "last "
      "of the included files, then\nthose before it, then the base. `--include FILE.toml` on the "
      "command line lays a file over the scenario,\nunder `--set`.\n";
  return text + reference_tables(outline) + unit_section();
}

}  // namespace hvp::scenario
