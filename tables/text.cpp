#include "tables/text.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace hvp::tables {

std::string scientific(double value) {
  if (value == 0) return "0";
  if (!std::isfinite(value)) return "none";
  const std::string digits = fmt::format("{:.1e}", value);
  const std::size_t exponent = digits.find('e');
  return digits.substr(0, exponent) + "e" + std::to_string(std::stoi(digits.substr(exponent + 1)));
}

MarkdownTable::MarkdownTable(std::vector<std::string> heads) : columns_(heads.size()) {
  rows_.push_back(std::move(heads));
  rows_.emplace_back(columns_, "---");
}

void MarkdownTable::add(std::vector<std::string> row) {
  if (row.size() != columns_) throw std::logic_error("a row of another length than its table");
  rows_.push_back(std::move(row));
}

std::string MarkdownTable::text() const {
  std::string text;
  for (const std::vector<std::string>& row : rows_) {
    text += "|";
    for (const std::string& cell : row) text += " " + cell + " |";
    text += "\n";
  }
  return text;
}

}  // namespace hvp::tables
