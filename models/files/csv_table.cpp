#include "models/files/csv_table.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "models/files/csv.h"

namespace hvp::files {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool is_utf16(std::string_view text) {
  return text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF");
}

std::string with_single_quotes(std::string_view name) {
  std::string result(name);
  for (auto at = result.find("\"\""); at != std::string::npos; at = result.find("\"\"", at + 1)) {
    result.erase(at, 1);
  }
  return result;
}

}  // namespace

CsvTable::CsvTable(std::istream& in, std::string name) : name_(std::move(name)), lines_(in) {
  read_header();
}

void CsvTable::read_header() {
  std::string_view header;
  for (bool found = false; !found && next_line();) {
    header = lines_.line();
    if (lines_.number() == 1) {
      if (is_utf16(header)) {
        throw InputError(fmt::format("{}: is UTF-16: expected UTF-8 or ASCII", name_));
      }
      if (header.starts_with(kByteOrderMark)) header.remove_prefix(kByteOrderMark.size());
    }
    const std::string_view text = trimmed(header);
    if (text.starts_with('#') && title_.empty()) {
      title_ = text.substr(std::min(text.find_first_not_of("# "), text.size()));
    }
    found = !text.empty() && !text.starts_with('#');
    // An empty file's header is where it would have been.
    header_line_ = found ? lines_.number() : lines_.number() + 1;
    if (!found) header = {};
  }
  delimiter_ = csv_delimiter(header);
  for (const std::string_view cell : csv_cells(header, delimiter_)) {
    columns_.push_back(with_single_quotes(cell));
  }
  if (columns_.size() > 1 && columns_.back().empty()) columns_.pop_back();
}

std::optional<std::size_t> CsvTable::find(std::string_view column) const {
  const auto found = std::find(columns_.begin(), columns_.end(), column);
  if (found == columns_.end()) return {};
  return static_cast<std::size_t>(found - columns_.begin());
}

std::size_t CsvTable::column(std::string_view column) const {
  if (const auto found = find(column)) return *found;
  throw InputError(fmt::format("{}:{}: has no column '{}'", name_, header_line_, column));
}

bool CsvTable::next() {
  if (!next_of_any_length()) return false;
  if (fields_.size() != columns_.size())
    throw InputError(
        fmt::format("{}: {} fields, the header has {}", where(), fields_.size(), columns_.size()));
  return true;
}

bool CsvTable::next_of_any_length() {
  while (next_line()) {
    const std::string_view text = trimmed(lines_.line());
    if (text.empty() || text.starts_with('#')) continue;
    csv_cells(lines_.line(), delimiter_, fields_);
    if (fields_.size() == columns_.size() + 1 && fields_.back().empty()) fields_.pop_back();
    return true;
  }
  return false;
}

double CsvTable::number_or_nan(std::size_t column) const {
  return text(column).empty() ? std::numeric_limits<double>::quiet_NaN() : number<double>(column);
}

bool CsvTable::next_line() {
  try {
    return lines_.next();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}:{}: {}", name_, lines_.number() + 1, error.what()));
  }
}

}  // namespace hvp::files
