#include "models/sparse/matrix_market.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <istream>
#include <ostream>
#include <string>
#include <tuple>

#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::sparse {
namespace {

// Beyond this no board of the kind modelled here could hold the matrix, and a mistyped size line
// must not exhaust memory.
constexpr std::int64_t kMostRows = 3'000'000;

constexpr double kSymmetryTolerance = 1e-12;

std::size_t index(std::int64_t i) { return static_cast<std::size_t>(i); }

bool equals_transpose(const BlockMatrix& a) {
  for (int i = 0; i < a.block_rows(); ++i) {
    for (int k = a.row_begin[index(i)]; k < a.row_begin[index(i) + 1]; ++k) {
      const std::ptrdiff_t mirror = a.find(a.column[index(k)], i);
      if (mirror < 0) return false;
      for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 3; ++c) {
          if (a.block(index(k))[3 * r + c] != a.block(index(mirror))[3 * c + r]) return false;
        }
      }
    }
  }
  return true;
}

// Calls visit(row, column, value) row by row, of the lower triangle or of all entries.
template <class Visit>
void for_each_entry(const BlockMatrix& a, bool lower_only, const Visit& visit) {
  for (int i = 0; i < a.block_rows(); ++i) {
    for (int r = 0; r < 3; ++r) {
      for (int k = a.row_begin[index(i)]; k < a.row_begin[index(i) + 1]; ++k) {
        for (int c = 0; c < 3; ++c) {
          const int row = 3 * i + r;
          const int column = 3 * a.column[index(k)] + c;
          if (lower_only && column > row) continue;
          visit(row, column, a.block(index(k))[index(3 * r + c)]);
        }
      }
    }
  }
}

void write_comment(std::ostream& out, std::string_view comment) {
  if (!comment.empty()) out << "% " << comment << '\n';
}

// A message quotes the file, whose bytes need be no text: it stays one short, printable line.
std::string quoted(std::string_view word) {
  constexpr std::size_t kLongest = 40;
  std::string result(word.substr(0, kLongest));
  for (char& c : result) {
    if (c < ' ' || c > '~') c = '?';
  }
  return word.size() > kLongest ? result + "..." : result;
}

struct Header {
  bool coordinate = false;
  bool symmetric = false;
};

class Reader {
 public:
  Reader(std::istream& in, std::string_view name) : in_(in), name_(name) {}

  Header header() {
    if (!next_line()) fail("the file is empty; expected a Matrix Market banner");
    std::vector<std::string_view> word = words();
    std::string lower(line_);
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    line_ = lower;
    word = words();
    if (word.size() != 5 || word[0] != "%%matrixmarket" || word[1] != "matrix") {
      fail("expected '%%MatrixMarket matrix coordinate real symmetric' or the like");
    }
    if (word[2] != "coordinate" && word[2] != "array") {
      fail(fmt::format("the format is '{}'; expected coordinate or array", quoted(word[2])));
    }
    if (word[3] != "real" && word[3] != "integer" && word[3] != "double") {
      fail(fmt::format("the entries are '{}'; expected real or integer", quoted(word[3])));
    }
    if (word[4] != "symmetric" && word[4] != "general") {
      fail(fmt::format("the symmetry is '{}'; expected symmetric or general", quoted(word[4])));
    }
    return {.coordinate = word[2] == "coordinate", .symmetric = word[4] == "symmetric"};
  }

  // The next line that is neither empty nor a comment, as its words; empty at the end.
  std::vector<std::string_view> content() {
    while (next_line()) {
      std::vector<std::string_view> word = words();
      if (!word.empty() && word[0][0] != '%') return word;
    }
    return {};
  }

  std::vector<std::string_view> content(std::size_t count, std::string_view expected) {
    std::vector<std::string_view> word = content();
    if (word.size() != count) {
      fail(word.empty() ? fmt::format("the file ends; expected {}", expected)
                        : fmt::format("found {} words; expected {}", word.size(), expected));
    }
    return word;
  }

  std::int64_t integer(std::string_view word, std::int64_t min, std::int64_t max,
                       std::string_view what) const {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || value < min || value > max) {
      fail(fmt::format("the {} is '{}'; expected an integer from {} to {}", what, quoted(word), min,
                       max));
    }
    return value;
  }

  double number(std::string_view word) const {
    std::string_view digits = word;
    if (digits.size() > 1 && digits[0] == '+') digits.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value)) {
      fail(fmt::format("the entry is '{}'; expected a finite number", quoted(word)));
    }
    return value;
  }

  void expect_end(std::int64_t entries) {
    if (!content().empty()) fail(fmt::format("more than the stated {} entries", entries));
  }

  [[noreturn]] void fail(const std::string& message) const { fail_at(line_number_, message); }
  [[noreturn]] void fail_at(std::int64_t line, const std::string& message) const {
    throw InputError(fmt::format("{}, line {}: {}", name_, line, message));
  }
  std::int64_t line_number() const { return line_number_; }

 private:
  bool next_line() {
    if (!std::getline(in_, line_)) return false;
    ++line_number_;
    return true;
  }

  std::vector<std::string_view> words() const {
    std::vector<std::string_view> result;
    const std::string_view line = line_;
    for (std::size_t at = 0; at < line.size();) {
      const std::size_t first = line.find_first_not_of(" \t\r", at);
      if (first == std::string_view::npos) break;
      const std::size_t last = std::min(line.find_first_of(" \t\r", first), line.size());
      result.push_back(line.substr(first, last - first));
      at = last;
    }
    return result;
  }

  std::istream& in_;
  std::string name_;
  std::string line_;
  std::int64_t line_number_ = 0;
};

struct Entry {
  int row;
  int column;
  double value;
  std::int64_t line;
};

auto place_of(const Entry& entry) { return std::tuple(entry.row, entry.column); }

// The blocks that the entries touch, their mirrors and every diagonal block.
BlockMatrix pattern_of(const std::vector<Entry>& entries, int block_rows) {
  std::vector<std::pair<int, int>> blocks;
  blocks.reserve(2 * entries.size() + index(block_rows));
  for (const Entry& entry : entries) {
    blocks.emplace_back(entry.row / 3, entry.column / 3);
    blocks.emplace_back(entry.column / 3, entry.row / 3);
  }
  for (int i = 0; i < block_rows; ++i) blocks.emplace_back(i, i);
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  BlockMatrix result;
  result.row_begin.assign(index(block_rows) + 1, 0);
  for (const auto& [row, column] : blocks) {
    ++result.row_begin[index(row) + 1];
    result.column.push_back(column);
  }
  for (int i = 0; i < block_rows; ++i) {
    result.row_begin[index(i) + 1] += result.row_begin[index(i)];
  }
  result.value.assign(9 * result.column.size(), 0.0);
  return result;
}

// The line of an entry, or that of its mirror where it stands in none. `entries` is sorted by
// place.
std::int64_t line_of(const std::vector<Entry>& entries, int row, int column) {
  for (const auto& place : {std::tuple(row, column), std::tuple(column, row)}) {
    const auto found = std::ranges::lower_bound(entries, place, {}, place_of);
    if (found != entries.end() && place_of(*found) == place) return found->line;
  }
  return 0;
}

void expect_symmetric(const BlockMatrix& a, const std::vector<Entry>& entries,
                      const Reader& reader) {
  double largest = 0;
  for (const double entry : a.value) largest = std::max(largest, std::abs(entry));
  for (int i = 0; i < a.block_rows(); ++i) {
    for (int k = a.row_begin[index(i)]; k < a.row_begin[index(i) + 1]; ++k) {
      const double* mirror = a.block(index(a.find(a.column[index(k)], i)));
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) {
          const double here = a.block(index(k))[index(3 * r + c)];
          const double there = mirror[index(3 * c + r)];
          if (std::abs(here - there) <= kSymmetryTolerance * largest) continue;
          const int row = 3 * i + r;
          const int column = 3 * a.column[index(k)] + c;
          reader.fail_at(line_of(entries, row, column),
                         fmt::format("the matrix is not symmetric: entry ({}, {}) is {} and its "
                                     "mirror {}",
                                     row + 1, column + 1, here, there));
        }
      }
    }
  }
}

}  // namespace

void write_matrix_market(std::ostream& out, const BlockMatrix& a, std::string_view comment) {
  const bool symmetric = equals_transpose(a);
  std::size_t entries = 0;
  for_each_entry(a, symmetric, [&entries](int, int, double) { ++entries; });
  out << "%%MatrixMarket matrix coordinate real " << (symmetric ? "symmetric" : "general") << '\n';
  write_comment(out, comment);
  out << fmt::format("{} {} {}\n", a.rows(), a.rows(), entries);
  for_each_entry(a, symmetric, [&out](int row, int column, double value) {
    out << fmt::format("{} {} {}\n", row + 1, column + 1, value);
  });
}

void write_matrix_market(std::ostream& out, std::span<const double> vector,
                         std::string_view comment) {
  out << "%%MatrixMarket matrix array real general\n";
  write_comment(out, comment);
  out << fmt::format("{} 1\n", vector.size());
  for (const double entry : vector) out << fmt::format("{}\n", entry);
}

SquareMatrix read_matrix_market(std::istream& in, std::string_view name) {
  Reader reader(in, name);
  const Header header = reader.header();
  if (!header.coordinate) reader.fail("the matrix is dense ('array'); expected 'coordinate'");
  const auto size = reader.content(3, "three numbers: rows, columns, entries");
  const std::int64_t rows = reader.integer(size[0], 1, kMostRows, "number of rows");
  const std::int64_t columns = reader.integer(size[1], 1, kMostRows, "number of columns");
  if (rows != columns) {
    reader.fail(fmt::format("the matrix is {} × {}; expected a square one", rows, columns));
  }
  const std::int64_t count = reader.integer(size[2], 1, rows * rows, "number of entries");

  std::vector<Entry> entries;
  for (std::int64_t i = 0; i < count; ++i) {
    const auto word =
        reader.content(3, fmt::format("entry {} of {}: row, column, value", i + 1, count));
    Entry entry{};
    entry.row = static_cast<int>(reader.integer(word[0], 1, rows, "row")) - 1;
    entry.column = static_cast<int>(reader.integer(word[1], 1, rows, "column")) - 1;
    entry.value = reader.number(word[2]);
    entry.line = reader.line_number();
    if (header.symmetric && entry.column > entry.row) {
      reader.fail(
          fmt::format("entry ({}, {}) lies above the diagonal; a symmetric file lists the "
                      "lower triangle",
                      entry.row + 1, entry.column + 1));
    }
    entries.push_back(entry);
  }
  reader.expect_end(count);
  std::ranges::stable_sort(entries, {}, place_of);
  for (std::size_t i = 1; i < entries.size(); ++i) {
    if (place_of(entries[i]) != place_of(entries[i - 1])) continue;
    reader.fail_at(entries[i].line,
                   fmt::format("entry ({}, {}) is given twice, in line {} too", entries[i].row + 1,
                               entries[i].column + 1, entries[i - 1].line));
  }

  // Also keeps the memory in proportion to the file, whatever its size line says.
  if (count < rows) {
    reader.fail(fmt::format("{} rows have {} entries: a row is empty", rows, count));
  }

  SquareMatrix result;
  result.rows = static_cast<int>(rows);
  const int block_rows = (result.rows + 2) / 3;
  result.matrix = pattern_of(entries, block_rows);
  BlockMatrix& a = result.matrix;
  const auto at = [&a](int row, int column) -> double& {
    return a.block(index(a.find(row / 3, column / 3)))[index(3 * (row % 3) + column % 3)];
  };
  double diagonal = 0;
  for (const Entry& entry : entries) {
    at(entry.row, entry.column) = entry.value;
    if (header.symmetric) at(entry.column, entry.row) = entry.value;
    // The sum itself could overflow.
    if (entry.row == entry.column) diagonal += entry.value / result.rows;
  }
  for (int i = result.rows; i < 3 * block_rows; ++i) at(i, i) = diagonal;
  if (!header.symmetric) expect_symmetric(a, entries, reader);
  return result;
}

std::vector<double> read_matrix_market_vector(std::istream& in, std::string_view name) {
  Reader reader(in, name);
  const Header header = reader.header();
  const auto size = header.coordinate ? reader.content(3, "three numbers: rows, columns, entries")
                                      : reader.content(2, "two numbers: rows, columns");
  const std::int64_t rows = reader.integer(size[0], 1, kMostRows, "number of rows");
  const std::int64_t columns = reader.integer(size[1], 1, kMostRows, "number of columns");
  if (rows != 1 && columns != 1) {
    reader.fail(fmt::format("the matrix is {} × {}; expected a vector", rows, columns));
  }
  const std::int64_t length = rows * columns;
  std::vector<double> result;
  if (!header.coordinate) {
    for (std::int64_t i = 0; i < length; ++i) {
      const auto word = reader.content(1, fmt::format("entry {} of {}", i + 1, length));
      result.push_back(reader.number(word[0]));
    }
    reader.expect_end(length);
    return result;
  }
  const std::int64_t count = reader.integer(size[2], 0, length, "number of entries");
  result.assign(index(length), 0.0);
  std::vector<char> given(result.size(), 0);
  for (std::int64_t i = 0; i < count; ++i) {
    const auto word =
        reader.content(3, fmt::format("entry {} of {}: row, column, value", i + 1, count));
    const std::int64_t row = reader.integer(word[0], 1, rows, "row");
    const std::int64_t column = reader.integer(word[1], 1, columns, "column");
    const std::size_t at = index(row + column - 2);
    if (given[at]) reader.fail(fmt::format("entry ({}, {}) is given twice", row, column));
    given[at] = 1;
    result[at] = reader.number(word[2]);
  }
  reader.expect_end(count);
  return result;
}

}  // namespace hvp::sparse
