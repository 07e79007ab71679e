#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "app/scenario/key_visitor.h"
#include "models/config/declaration.h"

// Declared settings as JSON.

namespace hvp::results {

// Writes a declared struct as JSON, with the keys of a scenario. Quantities are texts with their
// unit; an effect that is absent is null.
class SettingsJson : public scenario::KeyVisitor {
 public:
  SettingsJson() : stack_{&root_} {}
  const nlohmann::ordered_json& root() const { return root_; }

 protected:
  void key(std::string_view name, const scenario::Key& key, const config::Note&) override;
  void begin_table(std::string_view name, config::Note) override;
  void end_table() override { stack_.pop_back(); }
  bool begin_effect(std::string_view name, bool& present, const config::EffectNote&) override;
  void end_effect() override { stack_.pop_back(); }
  bool begin_optional(std::string_view name, bool& present, config::Note) override;
  void end_optional() override { stack_.pop_back(); }
  bool begin_list(std::string_view name, std::size_t& count, config::Note) override;
  void begin_item(std::size_t index) override;
  void end_item() override { stack_.pop_back(); }
  void end_list() override { stack_.pop_back(); }

 private:
  nlohmann::ordered_json& put(std::string_view name);

  nlohmann::ordered_json root_ = nlohmann::ordered_json::object();
  std::vector<nlohmann::ordered_json*> stack_;  // the current table and those around it
};

// The value of a key. A quantity is a text with its unit, a number where it is dimensionless.
nlohmann::ordered_json value_json(const scenario::Key& key);

template <class Part>
nlohmann::ordered_json settings_json(const Part& part) {
  Part copy = part;  // declare() takes what it may also fill
  SettingsJson visitor;
  visitor.visit(copy);
  return visitor.root();
}

}  // namespace hvp::results
