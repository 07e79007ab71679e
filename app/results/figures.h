#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "models/config/figures.h"

// Visitors of declared figures: as a list, and as JSON.

namespace hvp::results {

// A declared figure by its whole key: "deadline.worst_us", "latency.by_part[].share" of a list's
// items. Unit and help live as long as the program.
struct ListedFigure {
  std::string key;
  std::string_view unit;
  std::string_view help;
  config::FigureValue value;
};

// Collects declared figures in the order of summary.json.
class FigureList : public config::Figures {
 public:
  enum class Of {
    run,          // the figures that occur once, with their values: the columns of a study
    declaration,  // all figures that can occur, and the tables that have help, as
                  // "deadline.lateness.*"
  };
  explicit FigureList(Of of) : of_(of) {}

  const std::vector<ListedFigure>& figures() const { return figures_; }

  void value(std::string_view key, const config::FigureValue& value, std::string_view unit,
             std::string_view help) override;

 protected:
  void begin_table(std::string_view key, std::string_view help) override;
  void end_table() override { prefixes_.pop_back(); }
  void begin_list(std::string_view key, std::string_view help) override;
  void begin_item() override {}
  void end_item() override {}
  void end_list() override;
  bool describes_only() const override { return of_ == Of::declaration; }

 private:
  std::string path(std::string_view key) const;

  Of of_;
  int lists_ = 0;                      // the lists around the current figure
  std::vector<std::string> prefixes_;  // "", "bus.", "bus.utilisation."
  std::vector<ListedFigure> figures_;
};

template <class Part>
std::vector<ListedFigure> figures_of(const Part& part) {
  FigureList list(FigureList::Of::run);
  list.report(part);
  return list.figures();
}
template <class Part>
std::vector<ListedFigure> declared_figures() {
  FigureList list(FigureList::Of::declaration);
  list.report(Part{});
  return list.figures();
}

// Writes declared figures as JSON, in the order in which they are declared.
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
  // The current table and those around it. The pointers stay valid: a table's siblings are added
  // only after it has ended.
  std::vector<nlohmann::ordered_json*> stack_;
};

template <class Part>
nlohmann::ordered_json figures_json(const Part& part) {
  FiguresJson visitor;
  visitor.report(part);
  return visitor.root();
}

}  // namespace hvp::results
