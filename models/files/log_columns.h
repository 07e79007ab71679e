#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "models/files/csv_table.h"
#include "models/files/log_table.h"
#include "models/files/log_units.h"

namespace hvp::files {

// Which columns of a table a log is read from. The time is the first one where there is one and
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
