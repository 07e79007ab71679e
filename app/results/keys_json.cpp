#include "app/results/keys_json.h"

#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "app/results/settings_json.h"
#include "app/scenario/message.h"
#include "app/scenario/quantity.h"

namespace hvp::results {

namespace {

using nlohmann::ordered_json;
using scenario::Key;
using scenario::Outline;
using scenario::OutlineRow;
using scenario::OutlineTable;

// What the tables around a key say of it.
struct Place {
  std::string path;    // with "[]" behind a list
  std::string effect;  // the nearest effect; empty: none
  bool in_list = false;
  std::vector<config::Condition> conditions = {};
};

Place place_in(const Outline& outline, const OutlineTable& table) {
  if (table.path.empty()) return {};
  const OutlineTable& parent = outline[table.parent];
  Place place = place_in(outline, parent);
  const std::size_t name = parent.path.empty() ? 0 : parent.path.size() + 1;
  place.path = scenario::joined(place.path, table.path.substr(name));
  if (table.is_effect) place.effect = place.path;
  if (table.kind == OutlineTable::Kind::list) {
    place.path += "[]";
    place.in_list = true;
  }
  place.conditions.insert(place.conditions.end(), table.conditions.begin(), table.conditions.end());
  return place;
}

ordered_json range_json(const ordered_json& min, const ordered_json& max, bool min_open,
                        bool max_open) {
  return {{"min", min}, {"max", max}, {"min_open", min_open}, {"max_open", max_open}};
}

ordered_json range_json(const config::Range& range) {
  // A number where there is a bound; null elsewhere.
  const auto bound = [](double value) {
    return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
  };
  return range_json(bound(range.min), bound(range.max), range.min_open, range.max_open);
}

// A type's own bound says nothing about the parameter.
ordered_json range_json(const config::IntegerRange& range) {
  using Narrow = std::numeric_limits<int>;
  using Wide = std::numeric_limits<std::int64_t>;
  const bool low = range.min != Narrow::min() && range.min != Wide::min();
  const bool high = range.max != Narrow::max() && range.max != Wide::max();
  return range_json(low ? ordered_json(range.min) : ordered_json(nullptr),
                    high ? ordered_json(range.max) : ordered_json(nullptr), false, false);
}

ordered_json conditions_json(const std::vector<config::Condition>& conditions) {
  ordered_json list = ordered_json::array();
  for (const config::Condition& condition : conditions) {
    if (condition.why_not_beside.empty()) {
      list.push_back({{"key", condition.key}, {"values", condition.values}});
    } else {
      list.push_back({{"not_beside", condition.key}});
    }
  }
  return list;
}

std::string_view type_name(Key::Kind kind) {
  switch (kind) {
    case Key::Kind::quantity:
      return "quantity";
    case Key::Kind::vector:
      return "vector";
    case Key::Kind::integer:
      return "integer";
    case Key::Kind::boolean:
      return "boolean";
    case Key::Kind::text:
      return "text";
    case Key::Kind::file:
      return "file";
    case Key::Kind::choice:
      break;
  }
  return "choice";
}

void add_default(ordered_json& json, const Key& key) {
  if (const auto* number = std::get_if<double>(&key.value)) {
    if (!std::isfinite(*number)) return;
    json["default_si"] = *number;
  } else if (const auto* vector = std::get_if<Eigen::Vector3d>(&key.value)) {
    if (!vector->allFinite()) return;
    json["default_si"] = {vector->x(), vector->y(), vector->z()};
  }
  json["default"] = value_json(key);
}

void add_dimension(ordered_json& json, const Key& key) {
  const std::string_view name = scenario::dimension_name(key.dimension);
  json["dimension"] = name.substr(name.find(' ') + 1);
  const std::vector<std::string_view> units = scenario::units_of(key.dimension);
  // The first is that of the SI, in which the range is.
  json["unit"] = units.empty() ? "" : units.front();
  json["units"] = units;
  json["range"] = range_json(key.range);
}

ordered_json key_json(const Place& place, const OutlineRow& row) {
  const Key& key = row.key;
  ordered_json json = {{"path", scenario::joined(place.path, scenario::key_text(row.name))},
                       {"type", type_name(key.kind)},
                       {"default", nullptr},
                       {"required", row.required},
                       {"help", row.help},
                       {"source", row.source},
                       {"effect", nullptr},
                       {"list_item", place.in_list}};
  if (!place.effect.empty()) json["effect"] = place.effect;
  std::vector<config::Condition> conditions = place.conditions;
  conditions.insert(conditions.end(), row.conditions.begin(), row.conditions.end());
  if (!conditions.empty()) json["only_with"] = conditions_json(conditions);
  if (!row.required) add_default(json, key);
  if (key.kind == Key::Kind::quantity || key.kind == Key::Kind::vector) add_dimension(json, key);
  if (key.kind == Key::Kind::integer) json["range"] = range_json(key.integers);
  if (key.kind == Key::Kind::choice) json["choices"] = key.choices;
  if (!key.word.empty()) json["word"] = key.word;
  return json;
}

}  // namespace

ordered_json keys_json(const Outline& outline) {
  std::size_t count = 0;
  for (const OutlineTable& table : outline) count += table.rows.size();
  ordered_json keys(std::vector<ordered_json>(count, nullptr));
  for (const OutlineTable& table : outline) {
    const Place place = place_in(outline, table);
    for (const OutlineRow& row : table.rows) keys[row.order] = key_json(place, row);
  }
  return keys;
}

ordered_json effects_json(const Outline& outline) {
  ordered_json effects = ordered_json::array();
  for (const OutlineTable& table : outline) {
    if (!table.is_effect) continue;
    ordered_json needs = ordered_json::array();
    for (const config::Need& need : table.needs) {
      needs.push_back({{"key", need.key}, {"values", need.values}, {"why", need.why}});
    }
    effects.push_back({{"path", place_in(outline, table).effect},
                       {"help", table.help},
                       {"adds", table.cost},
                       {"needs", needs},
                       {"list", table.kind == OutlineTable::Kind::list},
                       {"implied", table.implied}});
  }
  return effects;
}

}  // namespace hvp::results
