#pragma once

#include <charconv>
#include <cstddef>
#include <istream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/files/line_reader.h"
#include "models/files/one_line.h"

namespace hvp::files {

// A CSV file with a header line, read row by row: in the memory of one row, however many there are.
// The header's first tab or semicolon is what parts the cells, else commas do (csv.h). A byte-order
// mark, blank lines, lines that begin with '#' and one delimiter behind the last column do not
// matter. Throws hvp::InputError with file and line for what it cannot read.
class CsvTable {
 public:
  // `name` is what errors call the file. `in` has to outlive the table. A line that begins with '#'
  // above the header is the table's title. An empty file has one column without a name.
  CsvTable(std::istream& in, std::string name);

  const std::string& name() const { return name_; }    // of the file
  const std::string& title() const { return title_; }  // without the '#'; may be empty
  char delimiter() const { return delimiter_; }
  std::size_t header_line() const { return header_line_; }  // from 1
  const std::vector<std::string>& columns() const { return columns_; }
  std::optional<std::size_t> find(std::string_view column) const;
  // As above; throws where there is no such column.
  std::size_t column(std::string_view column) const;

  // Goes on to the next row. False at the end; throws for a row that has not a field a column.
  bool next();
  // The same, whatever number of fields the row has.
  bool next_of_any_length();
  // Of the row at hand.
  std::size_t line() const { return lines_.number(); }
  std::string where() const { return fmt::format("{}:{}", name_, line()); }
  std::size_t fields() const { return fields_.size(); }
  // Nothing where the row is too short.
  std::string_view text(std::size_t column) const {
    return column < fields_.size() ? fields_[column] : std::string_view{};
  }
  template <class Number>
  Number number(std::size_t column) const {
    const std::string_view field = text(column);
    Number value{};
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc() || end != field.data() + field.size())
      throw InputError(fmt::format("{}: {} is '{}', expected a number", where(),
                                   one_line(columns_[column]), one_line(field, 60)));
    return value;
  }
  // NaN where the field is empty.
  double number_or_nan(std::size_t column) const;

 private:
  bool next_line();
  void read_header();

  std::string name_;
  LineReader lines_;
  std::string title_;
  std::vector<std::string> columns_;
  std::size_t header_line_ = 1;
  char delimiter_ = ',';
  std::vector<std::string_view> fields_;  // views into the line
};

}  // namespace hvp::files
