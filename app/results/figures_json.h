#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "models/config/figures.h"

namespace hvp::results {

// Declared figures as JSON, in the order in which they are declared.
class FiguresJson : public config::Figures {
 public:
  FiguresJson() : stack_{&root_} {}
  const nlohmann::ordered_json& root() const { return root_; }

  void value(std::string_view key, const config::FigureValue& value, std::string_view unit,
             std::string_view help) override;

 protected:
  void begin_table(std::string_view key, std::string_view help) override;
  void end_table() override { stack_.pop_back(); }
  void begin_list(std::string_view key, std::string_view help) override;
  void begin_item() override;
  void end_item() override { stack_.pop_back(); }
  void end_list() override { stack_.pop_back(); }

 private:
  nlohmann::ordered_json& put(std::string_view key) { return (*stack_.back())[std::string(key)]; }

  nlohmann::ordered_json root_ = nlohmann::ordered_json::object();
  // Of the table at hand and those around it. What stands beside one is added after it was left.
  std::vector<nlohmann::ordered_json*> stack_;
};

template <class Part>
nlohmann::ordered_json figures_json(const Part& part) {
  FiguresJson visitor;
  visitor.report(part);
  return visitor.root();
}

}  // namespace hvp::results
