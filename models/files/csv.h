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
#include "models/files/one_line.h"

namespace hvp::files {

// The cells of a line of a CSV file, separated by `delimiter`: at least one, views into `line`,
// without the blanks around them. A cell in double quotes may contain the delimiter (RFC 4180); it
// is returned without the quotes, and a doubled quote inside stays doubled. A quote that is not
// closed on the line is a character as any other.
std::vector<std::string_view> csv_cells(std::string_view line, char delimiter = ',');
// The same, written to a list of the caller's, for a table of many lines.
void csv_cells(std::string_view line, char delimiter, std::vector<std::string_view>& cells);

// The delimiter of a table: tab or semicolon where the header has one outside quotes, in this
// order; else a comma.
char csv_delimiter(std::string_view header);

// The text without blanks, tabs and carriage returns around it.
std::string_view trimmed(std::string_view text);

// The double nearest to the decimal number that is all of `text`, such as "-1.5e-3" or "+2", times
// 10^exponent: rounded once, so that 0.1 ms is the double that 0.0001 s is. Nothing for any other
// text, NaN and infinity included, and where the number overflows, or underflows to zero.
std::optional<double> decimal_number(std::string_view text, int exponent = 0);

// Reads the lines of a text of any length, one after the other. A line ends in LF or CRLF, the last
// one also without.
class LineReader {
 public:
  // The limit of a line, in bytes, and so of the memory for a file without line ends.
  static constexpr std::size_t kLongestLine = std::size_t{1} << 20U;

  explicit LineReader(std::istream& in) : in_(in), buffer_(std::size_t{1} << 16U) {}

  // Reads the next line. False at the end. Throws InputError, with neither file nor line, for one
  // of more than kLongestLine.
  bool next();
  std::string_view line() const { return line_; }  // without its end; until the next one
  std::size_t number() const { return number_; }   // number of the line, from 1

 private:
  void read_more();

  std::istream& in_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  // begin of the unread bytes in the buffer
  std::size_t end_ = 0;
  bool at_end_ = false;
  std::string_view line_;
  std::size_t number_ = 0;
};

// A CSV file with a header line, read row by row: its memory is that of one row. The header's first
// tab or semicolon is the delimiter, else the comma is. A byte-order mark, blank lines, lines that
// begin with '#' and one delimiter behind the last column are ignored. Throws hvp::InputError with
// file and line for what it cannot read.
class CsvTable {
 public:
  // `name` is the file's name in errors. `in` must outlive the table. A line that begins with '#'
  // above the header is the table's title. An empty file has one column without a name.
  CsvTable(std::istream& in, std::string name);

  const std::string& name() const { return name_; }    // the file's name
  const std::string& title() const { return title_; }  // without the '#'; may be empty
  char delimiter() const { return delimiter_; }
  std::size_t header_line() const { return header_line_; }  // from 1
  const std::vector<std::string>& columns() const { return columns_; }
  std::optional<std::size_t> find(std::string_view column) const;
  // The index of a column; throws where there is none of that name.
  std::size_t column(std::string_view column) const;

  // Reads the next row. False at the end; throws for a row whose number of fields differs from that
  // of the columns.
  bool next();
  // The same, whatever number of fields the row has.
  bool next_of_any_length();
  // The line of the present row.
  std::size_t line() const { return lines_.number(); }
  std::string where() const { return fmt::format("{}:{}", name_, line()); }
  std::size_t fields() const { return fields_.size(); }
  // The field of a column; empty where the row is too short.
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
