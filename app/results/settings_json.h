#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "models/config/declaration.h"

// Visitors of declared settings: their values as JSON, and the declaration itself as JSON.

namespace hvp::results {

// Writes a declared struct as JSON, with the keys of a scenario. Quantities are texts with their
// unit; an effect that is absent is null.
class SettingsJson : public config::Visitor {
 public:
  SettingsJson() : stack_{&root_} {}
  const nlohmann::ordered_json& root() const { return root_; }

  using config::Visitor::integer;
  void quantity(std::string_view name, double& value, config::Dimension dimension, config::Range,
                config::Note) override;
  void vector(std::string_view name, Eigen::Vector3d& value, config::Dimension dimension,
              config::Range, config::Note) override;
  void integer(std::string_view name, std::int64_t& value, config::IntegerRange,
               config::Note) override;
  void boolean(std::string_view name, bool& value, config::Note) override;
  void text(std::string_view name, std::string& value, config::Note) override;
  void file(std::string_view name, config::File& file, config::Note) override;
  void choice_index(std::string_view name, std::size_t& index,
                    const std::vector<std::string_view>& names, config::Note) override;

 protected:
  void begin_table(std::string_view name, config::Note) override;
  void end_table() override { stack_.pop_back(); }
  bool begin_effect(std::string_view name, bool& present, const config::EffectNote&) override;
  void end_effect() override { stack_.pop_back(); }
  bool begin_list(std::string_view name, std::size_t& count, config::Note) override;
  void begin_item(std::size_t index) override;
  void end_item() override { stack_.pop_back(); }
  void end_list() override { stack_.pop_back(); }

 private:
  nlohmann::ordered_json& put(std::string_view name);

  nlohmann::ordered_json root_ = nlohmann::ordered_json::object();
  std::vector<nlohmann::ordered_json*> stack_;  // the current table and those around it
};

// A text with its unit; a number where the quantity is dimensionless.
nlohmann::ordered_json quantity_json(double value, config::Dimension dimension);

template <class Part>
nlohmann::ordered_json settings_json(const Part& part) {
  Part copy = part;  // declare() takes what it may also fill
  SettingsJson visitor;
  visitor.visit(copy);
  return visitor.root();
}

// Writes a declaration as JSON: every key that a scenario may have, and every effect, in the order
// of their declaration. docs/json.md describes the format.
class KeysJson : public config::Visitor {
 public:
  const nlohmann::ordered_json& keys() const { return keys_; }
  const nlohmann::ordered_json& effects() const { return effects_; }

  using config::Visitor::integer;
  void quantity(std::string_view name, double& value, config::Dimension dimension,
                config::Range range, config::Note note) override;
  void vector(std::string_view name, Eigen::Vector3d& value, config::Dimension dimension,
              config::Range range, config::Note note) override;
  void integer(std::string_view name, std::int64_t& value, config::IntegerRange range,
               config::Note note) override;
  void boolean(std::string_view name, bool& value, config::Note note) override;
  void text(std::string_view name, std::string& value, config::Note note) override;
  void file(std::string_view name, config::File& file, config::Note note) override;
  void choice_index(std::string_view name, std::size_t& index,
                    const std::vector<std::string_view>& names, config::Note note) override;

 protected:
  void begin_table(std::string_view name, config::Note) override { enter(name); }
  void end_table() override { levels_.pop_back(); }
  bool begin_effect(std::string_view name, bool& present, const config::EffectNote& note) override;
  void end_effect() override { levels_.pop_back(); }
  bool begin_list(std::string_view name, std::size_t& count, config::Note) override;
  void begin_item(std::size_t /*index*/) override {}
  void end_item() override {}
  void end_list() override { levels_.pop_back(); }
  void list_is_effect(std::string_view name, bool present, const config::EffectNote& note) override;
  bool begin_condition(const config::Condition& condition) override;
  void end_condition() override { levels_.back().conditions.pop_back(); }
  bool describes_only() const override { return true; }

 private:
  struct Level {
    std::string path;
    std::string effect;  // the effect around the current keys; empty: none
    bool in_list = false;
    std::vector<nlohmann::ordered_json> conditions = {};
  };

  std::string path_of(std::string_view name) const;
  void enter(std::string_view name);
  void add_effect(const std::string& path, bool list, const config::EffectNote& note);
  nlohmann::ordered_json& add(std::string_view name, std::string_view type,
                              const config::Note& note);
  void add_dimension(nlohmann::ordered_json& key, config::Dimension dimension,
                     const config::Range& range) const;

  std::vector<Level> levels_ = {{}};
  nlohmann::ordered_json keys_ = nlohmann::ordered_json::array();
  nlohmann::ordered_json effects_ = nlohmann::ordered_json::array();
};

}  // namespace hvp::results
