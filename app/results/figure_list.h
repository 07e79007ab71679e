#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "models/config/figures.h"

namespace hvp::results {

// A declared figure by its whole key: "deadline.worst_us", "latency.by_part[].share" of a list's
// items. Unit and help live as long as the program.
struct ListedFigure {
  std::string key;
  std::string_view unit;
  std::string_view help;
  config::FigureValue value;
};

// Declared figures one after the other.
class FigureList : public config::Figures {
 public:
  enum class Of {
    run,          // what is there once, with its value: what a study has columns for
    declaration,  // all that can be there; tables too, as "deadline.lateness.*", where they have
                  // help
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
  int lists_ = 0;                      // around the figure at hand
  std::vector<std::string> prefixes_;  // "", "bus.", "bus.utilisation."
  std::vector<ListedFigure> figures_;
};

// In the order of summary.json.
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

}  // namespace hvp::results
