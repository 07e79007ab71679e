#include "models/files/csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <iterator>
#include <limits>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::files {

namespace {

// The end of a quoted cell, behind its closing quote; npos where `text` does not begin with one.
std::size_t quoted_end(std::string_view text) {
  if (!text.starts_with('"')) return std::string_view::npos;
  for (std::size_t quote = text.find('"', 1); quote != std::string_view::npos;
       quote = text.find('"', quote + 2)) {
    if (quote + 1 == text.size() || text[quote + 1] != '"') return quote + 1;
  }
  return std::string_view::npos;
}

bool is_blank(char c, char delimiter) {
  return (c == ' ' || c == '\t' || c == '\r') && c != delimiter;
}

// The end of the cell that begins at `begin`: a delimiter or the line's end.
std::size_t cell_end(std::string_view line, std::size_t begin, char delimiter) {
  std::size_t at = begin;
  while (at < line.size() && is_blank(line[at], delimiter)) ++at;
  const std::size_t quoted = quoted_end(line.substr(at));
  if (quoted != std::string_view::npos) {
    at += quoted;
    while (at < line.size() && is_blank(line[at], delimiter)) ++at;
    if (at == line.size() || line[at] == delimiter) return at;
  }
  const std::size_t end = line.find(delimiter, begin);
  return end == std::string_view::npos ? line.size() : end;
}

std::string_view without_quotes(std::string_view cell) {
  if (cell.size() < 2 || quoted_end(cell) != cell.size()) return cell;
  return trimmed(cell.substr(1, cell.size() - 2));
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

void csv_cells(std::string_view line, char delimiter, std::vector<std::string_view>& cells) {
  cells.clear();
  for (std::size_t begin = 0;;) {
    const std::size_t end = cell_end(line, begin, delimiter);
    cells.push_back(without_quotes(trimmed(line.substr(begin, end - begin))));
    if (end == line.size()) return;
    begin = end + 1;
  }
}

std::vector<std::string_view> csv_cells(std::string_view line, char delimiter) {
  std::vector<std::string_view> cells;
  csv_cells(line, delimiter, cells);
  return cells;
}

char csv_delimiter(std::string_view header) {
  bool semicolon = false;
  bool quoted = false;
  for (const char c : header) {
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    if (c == '\t') return '\t';
    semicolon = semicolon || c == ';';
  }
  return semicolon ? ';' : ',';
}

namespace {

// The largest exponent of a number. Only a zero can have a large one.
constexpr int kLargestExponent = 100000;

std::optional<double> number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

}  // namespace

std::optional<double> decimal_number(std::string_view text, int exponent) {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    if (text.starts_with('-')) return {};
  }
  const std::optional<double> plain = number(text);
  if (!plain || exponent == 0) return plain;
  const std::size_t e = std::min(text.find_first_of("eE"), text.size());
  int own = 0;
  if (e < text.size()) {
    const std::size_t digits = e + (text[e + 1] == '+' ? 2 : 1);
    std::from_chars(text.data() + digits, text.data() + text.size(), own);
  }
  fmt::memory_buffer scaled;
  fmt::format_to(std::back_inserter(scaled), "{}e{}", text.substr(0, e),
                 std::clamp(own, -kLargestExponent, kLargestExponent) + exponent);
  return number({scaled.data(), scaled.size()});
}

namespace {

[[noreturn]] void refuse() {
  throw InputError(fmt::format("a line of more than {} bytes: expected rows of a table",
                               LineReader::kLongestLine));
}

}  // namespace

bool LineReader::next() {
  std::size_t searched = 0;
  const void* end = nullptr;
  while (end == nullptr) {
    const std::size_t rest = end_ - begin_ - searched;
    if (rest > 0) end = std::memchr(&buffer_[begin_ + searched], '\n', rest);
    if (end != nullptr) break;
    searched = end_ - begin_;
    if (searched > kLongestLine) refuse();
    if (at_end_) break;
    read_more();
  }
  if (end == nullptr && begin_ == end_) {
    line_ = {};
    return false;
  }
  const char* const first = &buffer_[begin_];
  const std::size_t length =
      end == nullptr ? searched : static_cast<std::size_t>(static_cast<const char*>(end) - first);
  if (length > kLongestLine) refuse();
  begin_ += length + (end == nullptr ? 0 : 1);
  line_ = std::string_view(first, length);
  if (line_.ends_with('\r')) line_.remove_suffix(1);
  ++number_;
  return true;
}

void LineReader::read_more() {
  if (begin_ > 0) {
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_),
              buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
    end_ -= begin_;
    begin_ = 0;
  }
  if (end_ == buffer_.size()) buffer_.resize(2 * buffer_.size());
  in_.read(&buffer_[end_], static_cast<std::streamsize>(buffer_.size() - end_));
  end_ += static_cast<std::size_t>(in_.gcount());
  at_end_ = !in_;
}

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
