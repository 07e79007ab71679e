#pragma once

#include <algorithm>
#include <cstddef>
#include <istream>
#include <string>
#include <vector>

#include "models/config/input_error.h"
#include "models/files/csv.h"
#include "models/files/log_columns.h"
#include "models/files/log_table.h"

namespace hvp::files {

// The line of each sample. Rows that follow one another take no memory.
class LineOfSample {
 public:
  void add(std::size_t sample, std::size_t line) {
    if (begins_.empty() || line - begins_.back().line != sample - begins_.back().sample) {
      begins_.push_back({sample, line});
    }
  }
  std::size_t operator()(std::size_t sample) const {
    const auto behind = std::upper_bound(
        begins_.begin(), begins_.end(), sample,
        [](std::size_t wanted, const Begin& begin) { return wanted < begin.sample; });
    const Begin& begin = *(behind - 1);
    return begin.line + (sample - begin.sample);
  }

 private:
  struct Begin {
    std::size_t sample = 0;
    std::size_t line = 0;
  };
  std::vector<Begin> begins_;
};

// Reads the rows of a log into its columns. Whatever can be seen in a row alone, or in it and the
// one before, is refused, repaired or warned of here. See read_log().
class LogRows {
 public:
  LogRows(std::istream& in, const std::string& name, const LogOptions& options);

  // Reads all rows. The time is the log's first column where has_time().
  void read(Log& log);
  bool has_time() const { return has_time_; }
  // The line of a sample.
  std::size_t line_of(std::size_t sample) const { return lines_(sample); }

 private:
  // A repair that is made many times and reported once.
  struct Repair {
    std::size_t times = 0;
    std::size_t first_line = 0;
    void note(std::size_t line) {
      if (times++ == 0) first_line = line;
    }
  };

  void name_columns(Log& log) const;
  void take_row(Log& log);
  bool is_empty_row() const;
  void require_fields() const;
  double value(std::size_t i, const Log& log);
  // False for a row that repeats the one before.
  bool goes_on(const Log& log);
  void say_repairs(Log& log) const;
  InputError wrong(const std::string& what) const;

  const LogOptions& options_;
  CsvTable table_;
  LogChoice chosen_;
  std::vector<double> row_;
  bool has_time_ = false;
  bool just_repeated_ = false;
  std::size_t first_empty_ = 0;  // line of the first of the empty rows that may be the last ones
  Repair empty_above_;
  Repair comma_;
  Repair repeated_;
  LineOfSample lines_;
};

// A column in messages: "column 2 (force_N)".
std::string shown(const LogColumn& column);
// A message with its place: "log.csv:12: what".
std::string at_line(const std::string& file, std::size_t line, const std::string& what);

}  // namespace hvp::files
