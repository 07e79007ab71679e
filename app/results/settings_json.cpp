#include "app/results/settings_json.h"

#include "app/scenario/quantity.h"

namespace hvp::results {

using nlohmann::ordered_json;

ordered_json value_json(const scenario::Key& key) {
  struct Writing {
    config::Dimension dimension;
    ordered_json operator()(double value) const {
      if (dimension == config::Dimension::dimensionless) return value;
      return scenario::format_quantity(value, dimension);
    }
    ordered_json operator()(const Eigen::Vector3d& value) const {
      ordered_json list = ordered_json::array();
      for (const double component : value) list.push_back((*this)(component));
      return list;
    }
    ordered_json operator()(std::int64_t value) const { return value; }
    ordered_json operator()(bool value) const { return value; }
    ordered_json operator()(const std::string& value) const { return value; }
  };
  return std::visit(Writing{key.dimension}, key.value);
}

ordered_json& SettingsJson::put(std::string_view name) {
  return (*stack_.back())[std::string(name)];
}

void SettingsJson::key(std::string_view name, const scenario::Key& key,
                       const config::Note& /*note*/) {
  put(name) = value_json(key);
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

bool SettingsJson::begin_optional(std::string_view name, bool& present, config::Note note) {
  if (present) begin_table(name, note);
  return present;
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
