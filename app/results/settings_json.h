#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "models/config/declaration.h"

namespace hvp::results {

// A declared struct as JSON, with the keys of a scenario: quantities are texts with their unit, an
// effect that is absent is null.
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
  std::vector<nlohmann::ordered_json*> stack_;
};

// A text with its unit, or a number where there is no unit to state.
nlohmann::ordered_json quantity_json(double value, config::Dimension dimension);

template <class Part>
nlohmann::ordered_json settings_json(const Part& part) {
  Part copy = part;  // declare() takes what it may also fill
  SettingsJson visitor;
  visitor.visit(copy);
  return visitor.root();
}

}  // namespace hvp::results
