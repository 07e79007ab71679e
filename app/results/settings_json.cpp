#include "app/results/settings_json.h"

#include <cmath>
#include <limits>

#include "app/scenario/message.h"
#include "app/scenario/quantity.h"

namespace hvp::results {

using nlohmann::ordered_json;

ordered_json quantity_json(double value, config::Dimension dimension) {
  if (dimension == config::Dimension::dimensionless) return value;
  return scenario::format_quantity(value, dimension);
}

ordered_json& SettingsJson::put(std::string_view name) {
  return (*stack_.back())[std::string(name)];
}

void SettingsJson::quantity(std::string_view name, double& value, config::Dimension dimension,
                            config::Range, config::Note) {
  put(name) = quantity_json(value, dimension);
}

void SettingsJson::vector(std::string_view name, Eigen::Vector3d& value,
                          config::Dimension dimension, config::Range, config::Note) {
  ordered_json& list = put(name) = ordered_json::array();
  for (const double component : value) list.push_back(quantity_json(component, dimension));
}

void SettingsJson::integer(std::string_view name, std::int64_t& value, config::IntegerRange,
                           config::Note) {
  put(name) = value;
}

void SettingsJson::boolean(std::string_view name, bool& value, config::Note) { put(name) = value; }

void SettingsJson::text(std::string_view name, std::string& value, config::Note) {
  put(name) = value;
}

void SettingsJson::file(std::string_view name, config::File& file, config::Note) {
  put(name) = file.written;
}

void SettingsJson::choice_index(std::string_view name, std::size_t& index,
                                const std::vector<std::string_view>& names, config::Note) {
  put(name) = std::string(names[index]);
}

void SettingsJson::begin_table(std::string_view name, config::Note) {
  ordered_json& table = put(name) = ordered_json::object();
  stack_.push_back(&table);
}

bool SettingsJson::begin_effect(std::string_view name, bool& present, const config::EffectNote&) {
  ordered_json& table = put(name);
  if (!present) return false;
  table = ordered_json::object();
  stack_.push_back(&table);
  return true;
}

bool SettingsJson::begin_list(std::string_view name, std::size_t& /*count*/, config::Note) {
  ordered_json& list = put(name) = ordered_json::array();
  stack_.push_back(&list);
  return false;
}

void SettingsJson::begin_item(std::size_t /*index*/) {
  ordered_json& list = *stack_.back();
  list.push_back(ordered_json::object());
  stack_.push_back(&list.back());
}

namespace {

// A number where there is a bound; null elsewhere.
ordered_json bound(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

ordered_json range_json(const config::Range& range) {
  return {{"min", bound(range.min)},
          {"max", bound(range.max)},
          {"min_open", range.min_open},
          {"max_open", range.max_open}};
}

// A type's own bound says nothing about the parameter.
ordered_json range_json(const config::IntegerRange& range) {
  using Narrow = std::numeric_limits<int>;
  using Wide = std::numeric_limits<std::int64_t>;
  const bool low = range.min != Narrow::min() && range.min != Wide::min();
  const bool high = range.max != Narrow::max() && range.max != Wide::max();
  return {{"min", low ? ordered_json(range.min) : ordered_json(nullptr)},
          {"max", high ? ordered_json(range.max) : ordered_json(nullptr)},
          {"min_open", false},
          {"max_open", false}};
}

ordered_json condition_json(const config::Condition& condition) {
  if (!condition.why_not_beside.empty()) return {{"not_beside", condition.key}};
  return {{"key", condition.key}, {"values", condition.values}};
}

}  // namespace

std::string KeysJson::path_of(std::string_view name) const {
  return scenario::joined(levels_.back().path, scenario::key_text(name));
}

void KeysJson::enter(std::string_view name) {
  Level level = levels_.back();
  level.path = path_of(name);
  levels_.push_back(std::move(level));
}

ordered_json& KeysJson::add(std::string_view name, std::string_view type,
                            const config::Note& note) {
  const Level& level = levels_.back();
  ordered_json key = {{"path", path_of(name)}, {"type", type},
                      {"default", nullptr},    {"required", note.required},
                      {"help", note.help},     {"source", note.source},
                      {"effect", nullptr},     {"list_item", level.in_list}};
  if (!level.effect.empty()) key["effect"] = level.effect;
  if (!level.conditions.empty()) key["only_with"] = level.conditions;
  keys_.push_back(std::move(key));
  return keys_.back();
}

void KeysJson::add_dimension(ordered_json& key, config::Dimension dimension,
                             const config::Range& range) const {
  const std::string_view name = scenario::dimension_name(dimension);
  key["dimension"] = name.substr(name.find(' ') + 1);
  const std::vector<std::string_view> units = scenario::units_of(dimension);
  // The first is that of the SI, in which the range is.
  key["unit"] = units.empty() ? "" : units.front();
  key["units"] = units;
  key["range"] = range_json(range);
}

void KeysJson::quantity(std::string_view name, double& value, config::Dimension dimension,
                        config::Range range, config::Note note) {
  ordered_json& key = add(name, "quantity", note);
  if (!note.required && std::isfinite(value)) {
    key["default"] = quantity_json(value, dimension);
    key["default_si"] = value;
  }
  add_dimension(key, dimension, range);
}

void KeysJson::vector(std::string_view name, Eigen::Vector3d& value, config::Dimension dimension,
                      config::Range range, config::Note note) {
  ordered_json& key = add(name, "vector", note);
  if (!note.required && value.allFinite()) {
    for (const double component : value) {
      key["default"].push_back(quantity_json(component, dimension));
      key["default_si"].push_back(component);
    }
  }
  add_dimension(key, dimension, range);
}

void KeysJson::integer(std::string_view name, std::int64_t& value, config::IntegerRange range,
                       config::Note note) {
  ordered_json& key = add(name, "integer", note);
  if (!note.required) key["default"] = value;
  key["range"] = range_json(range);
}

void KeysJson::boolean(std::string_view name, bool& value, config::Note note) {
  ordered_json& key = add(name, "boolean", note);
  if (!note.required) key["default"] = value;
}

void KeysJson::text(std::string_view name, std::string& value, config::Note note) {
  ordered_json& key = add(name, "text", note);
  if (!note.required) key["default"] = value;
}

void KeysJson::file(std::string_view name, config::File& file, config::Note note) {
  ordered_json& key = add(name, "file", note);
  if (!note.required) key["default"] = file.written;
}

void KeysJson::choice_index(std::string_view name, std::size_t& index,
                            const std::vector<std::string_view>& names, config::Note note) {
  ordered_json& key = add(name, "choice", note);
  if (!note.required) key["default"] = names.at(index);
  key["choices"] = names;
}

void KeysJson::add_effect(const std::string& path, bool list, const config::EffectNote& note) {
  ordered_json needs = ordered_json::array();
  for (const config::Need& need : note.needs) {
    needs.push_back({{"key", need.key}, {"values", need.values}, {"why", need.why}});
  }
  effects_.push_back({{"path", path},
                      {"help", note.help},
                      {"adds", note.cost},
                      {"needs", needs},
                      {"list", list},
                      {"implied", note.implied}});
}

bool KeysJson::begin_effect(std::string_view name, bool& /*present*/,
                            const config::EffectNote& note) {
  enter(name);
  levels_.back().effect = levels_.back().path;
  add_effect(levels_.back().path, false, note);
  return true;
}

bool KeysJson::begin_list(std::string_view name, std::size_t& /*count*/, config::Note) {
  enter(name);
  levels_.back().path += "[]";
  levels_.back().in_list = true;
  return false;
}

// Its keys are there by now.
void KeysJson::list_is_effect(std::string_view name, bool /*present*/,
                              const config::EffectNote& note) {
  const std::string path = path_of(name);
  add_effect(path, true, note);
  for (ordered_json& key : keys_) {
    if (key["effect"].is_null() && key["path"].get<std::string>().starts_with(path + "[]")) {
      key["effect"] = path;
    }
  }
}

bool KeysJson::begin_condition(const config::Condition& condition) {
  levels_.back().conditions.push_back(condition_json(condition));
  return true;
}

}  // namespace hvp::results
