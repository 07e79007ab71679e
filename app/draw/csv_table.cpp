#include "app/draw/csv_table.h"

#include <algorithm>
#include <limits>

#include "models/files/csv.h"

namespace hvp::draw {

std::ifstream open_file(const std::filesystem::path& path) {
  // A pipe in its place would be waited for.
  std::ifstream file;
  if (std::filesystem::is_regular_file(path)) file.open(path, std::ios::binary);
  if (!file.is_open()) throw InputError(path.filename().string() + ": no such file");
  return file;
}

CsvTable::CsvTable(const std::filesystem::path& path)
    : file_(open_file(path)), name_(path.filename().string()) {
  next_line();
  if (line_.starts_with('#')) {
    title_ = line_.substr(std::min(line_.find_first_not_of("# "), line_.size()));
    next_line();
  }
  for (const std::string_view title : files::csv_cells(line_)) header_.emplace_back(title);
}

std::optional<std::size_t> CsvTable::find(std::string_view column) const {
  const auto found = std::find(header_.begin(), header_.end(), column);
  if (found == header_.end()) return {};
  return static_cast<std::size_t>(found - header_.begin());
}

std::size_t CsvTable::column(std::string_view column) const {
  if (const auto found = find(column)) return *found;
  throw InputError(fmt::format("{}:{}: has no column '{}'", name_, title_.empty() ? 1 : 2, column));
}

bool CsvTable::next() {
  if (!next_line()) return false;
  fields_ = files::csv_cells(line_);
  if (fields_.size() != header_.size())
    throw InputError(
        fmt::format("{}: {} fields, the header has {}", where(), fields_.size(), header_.size()));
  return true;
}

double CsvTable::number_or_nan(std::size_t column) const {
  return fields_[column].empty() ? std::numeric_limits<double>::quiet_NaN()
                                 : number<double>(column);
}

bool CsvTable::next_line() {
  if (!std::getline(file_, line_)) {
    line_.clear();
    return false;
  }
  ++line_number_;
  if (line_.ends_with('\r')) line_.pop_back();
  return true;
}

}  // namespace hvp::draw
