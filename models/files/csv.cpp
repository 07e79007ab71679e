#include "models/files/csv.h"

#include <cstddef>

namespace hvp::files {
namespace {

// Where a quoted cell ends, behind its closing quote; npos where `text` does not begin with one.
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

// Where the cell that begins at `begin` ends: at a delimiter or the line's end.
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

}  // namespace hvp::files
