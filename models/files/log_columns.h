#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/files/csv.h"
#include "models/files/log_table.h"

namespace hvp::files {

// A unit in the name of a log's column: 1 unit = factor · 10^exponent SI units.
struct LogUnit {
  std::string_view suffix;  // after an underscore: "mN"
  std::string_view si;      // "N"; "count" where a column has a resolution of its own
  int exponent;
  double factor = 1;
};

struct LogName {
  std::string quantity;  // "force"
  const LogUnit* unit = nullptr;
};

// The quantity and the unit of a column: "force_mN" is force in mN; "bytes" is a size and "count" a
// number. Empty for a name without one of the units.
std::optional<LogName> log_name(std::string_view column);

// The value of `text` in SI units, read as decimal_number() does.
std::optional<double> in_si(std::string_view text, const LogUnit& unit);

// The names that a column of the quantity in this SI unit may have: "force_N, force_mN or
// force_kN".
std::string log_names(std::string_view quantity, std::string_view si);

// The columns of a table from which a log is read. The time is the first one where there is one and
// the options want a log over time.
struct LogChoice {
  struct Column {
    std::size_t index = 0;  // of the table
    LogName name;
  };
  std::vector<Column> columns;
  std::vector<std::string> left_aside;
};

// Throws InputError as read_log() does for what the header and the options say.
LogChoice choose_columns(const CsvTable& table, const LogOptions& options);

}  // namespace hvp::files
