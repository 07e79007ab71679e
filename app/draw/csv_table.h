#pragma once

#include <charconv>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::draw {

// Throws InputError for a file that is missing or not a regular one.
std::ifstream open_file(const std::filesystem::path& path);

// A CSV file with a header line, read row by row. Throws hvp::InputError with file and line for
// what it cannot read.
class CsvTable {
 public:
  // A first line that begins with '#' stands above the header and is the table's title.
  explicit CsvTable(const std::filesystem::path& path);

  const std::string& name() const { return name_; }    // of the file
  const std::string& title() const { return title_; }  // without the '#'; may be empty
  std::optional<std::size_t> find(std::string_view column) const;
  // As above; throws where there is no such column.
  std::size_t column(std::string_view column) const;

  // Goes on to the next row. False at the end; throws for a row that has not a field a column.
  bool next();
  // Of the row at hand.
  std::string where() const { return fmt::format("{}:{}", name_, line_number_); }
  std::string_view text(std::size_t column) const { return fields_[column]; }
  template <class Number>
  Number number(std::size_t column) const {
    const std::string_view field = fields_[column];
    Number value{};
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc() || end != field.data() + field.size())
      throw InputError(
          fmt::format("{}: {} is '{}', expected a number", where(), header_[column], field));
    return value;
  }
  // NaN where the field is empty.
  double number_or_nan(std::size_t column) const;

 private:
  bool next_line();

  std::ifstream file_;
  std::string name_;
  std::string title_;
  std::vector<std::string> header_;
  std::string line_;
  int line_number_ = 0;
  std::vector<std::string_view> fields_;  // views into line_
};

}  // namespace hvp::draw
