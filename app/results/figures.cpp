#include "app/results/figures.h"

#include <type_traits>

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

using nlohmann::ordered_json;

void FiguresJson::value(std::string_view key, const config::FigureValue& value,
                        std::string_view /*unit*/, std::string_view /*help*/) {
  put(key) = std::visit(
      [](const auto& v) -> ordered_json {
        if constexpr (std::is_same_v<std::decay_t<decltype(v)>, std::monostate>) {
          return nullptr;
        } else {
          return v;
        }
      },
      value);
}

void FiguresJson::begin_table(std::string_view key, std::string_view /*help*/) {
  ordered_json& table = put(key);
  if (!table.is_object()) table = ordered_json::object();
  stack_.push_back(&table);
}

void FiguresJson::begin_list(std::string_view key, std::string_view /*help*/) {
  ordered_json& list = put(key) = ordered_json::array();
  stack_.push_back(&list);
}

void FiguresJson::begin_item() {
  ordered_json& list = *stack_.back();
  list.push_back(ordered_json::object());
  stack_.push_back(&list.back());
}

}  // namespace hvp::results
