#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "models/config/declaration.h"

namespace hvp::results {

// A declaration as JSON: every key that a scenario may have, and every effect, in the order of
// their declaration. docs/json.md has the form.
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
    std::string effect;  // around the keys at hand; empty: none
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
