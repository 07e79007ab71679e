#include "app/results/settings_json.h"

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

}  // namespace hvp::results
