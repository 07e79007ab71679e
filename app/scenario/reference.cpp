#include "app/scenario/reference.h"

#include <array>
#include <string_view>

#include <fmt/format.h>

#include "app/scenario/message.h"
#include "app/scenario/quantity.h"
#include "app/scenario/toml_text.h"

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

// "only with `shape` = "sphere": "; empty where there is no condition.
std::string only_with(const std::vector<config::Condition>& conditions) {
  std::string text;
  for (const config::Condition& condition : conditions) {
    if (!text.empty()) text += ", ";
    text += condition.why_not_beside.empty()
                ? fmt::format("only with `{}` = {}", condition.key, alternatives(condition.values))
                : fmt::format("not beside `[{}]`", condition.key);
  }
  return text.empty() ? "" : cell(text) + ": ";
}

// The name of a dimension without its article: "time".
std::string bare_name(config::Dimension dimension) {
  const std::string_view name = dimension_name(dimension);
  return std::string(name.substr(name.find(' ') + 1));
}

std::string type_text(const Key& key) {
  switch (key.kind) {
    case Key::Kind::quantity:
      return bare_name(key.dimension);
    case Key::Kind::vector:
      return "three components, each a " + bare_name(key.dimension);
    case Key::Kind::integer:
      return "whole number";
    case Key::Kind::boolean:
      return "true or false";
    case Key::Kind::text:
      return "text";
    case Key::Kind::file:
      return "file";
    case Key::Kind::choice:
      break;
  }
  return "one of";
}

// Empty where any value is admitted.
std::string admitted(const Key& key) {
  if (key.kind == Key::Kind::integer) return range_text(key.integers);
  if (key.kind != Key::Kind::choice) {
    const std::string range = range_text(key.range, key.dimension);
    return key.word.empty() ? range : fmt::format("{}, or {}", range, toml_string(key.word));
  }
  std::vector<std::string> items;
  items.reserve(key.choices.size());
  for (const std::string& item : key.choices) items.push_back(toml_string(item));
  return alternatives(items);
}

std::string default_text(const OutlineRow& row) {
  if (row.required) return "required";
  const auto* name = std::get_if<std::string>(&row.key.value);
  const bool no_file = row.key.kind == Key::Kind::file && name->empty();
  return no_file ? "" : code(toml_value(row.key));
}

std::string sentence(const OutlineTable& table) {
  std::string text;
  if (table.kind == OutlineTable::Kind::effect) {
    text = "**Effect**: simulated only where the scenario has this table. ";
  } else if (table.kind == OutlineTable::Kind::list) {
    text = "**List**: one table an item. ";
  } else if (table.kind == OutlineTable::Kind::optional) {
    text = "**Optional**: absent where the scenario does not have this table. ";
  }
  if (table.required) text += "Required. ";
  text += only_with(table.conditions);
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
    text += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", row.name, cell(type_text(row.key)),
                        cell(admitted(row.key)), default_text(row),
                        only_with(row.conditions) + cell(row.help), cell(row.source));
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
    text +=
        fmt::format("| {} | {} | `\"{}\"` |\n", bare_name(entry.dimension), units, entry.example);
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
