#include "app/results/figure_list.h"

namespace hvp::results {

std::string FigureList::path(std::string_view key) const {
  return (prefixes_.empty() ? std::string() : prefixes_.back()) + std::string(key);
}

void FigureList::value(std::string_view key, const config::FigureValue& value,
                       std::string_view unit, std::string_view help) {
  if (lists_ > 0 && of_ == Of::run) return;
  figures_.push_back({path(key), unit, help, value});
}

void FigureList::begin_table(std::string_view key, std::string_view help) {
  if (of_ == Of::declaration && !help.empty()) figures_.push_back({path(key) + ".*", {}, help, {}});
  prefixes_.push_back(path(key) + '.');
}

void FigureList::begin_list(std::string_view key, std::string_view help) {
  ++lists_;
  begin_table(std::string(key) + "[]", help);
}

void FigureList::end_list() {
  --lists_;
  end_table();
}

}  // namespace hvp::results
