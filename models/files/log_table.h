#pragma once

#include <cstddef>
#include <filesystem>
#include <istream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/files/time_spacing.h"

namespace hvp::files {

struct LogOptions {
  // The quantities that are read beside the time, such as "force"; empty: every column whose name
  // ends in a unit.
  std::vector<std::string> quantities = {};
  // "force_N=Load": the header's column "Load", or column 3 of "force_N=3", is a force in N.
  std::vector<std::string> columns = {};
  // False: a list, such as one of transfers, in which the time is a quantity like any other.
  bool over_time = true;
  // 1/s, for a log without a column of the time.
  std::optional<double> sample_rate = {};
  // The size of one count of a column such as position_counts, in `count_unit`.
  std::optional<double> count_size = {};
  std::string count_unit = "rad";
  std::size_t least_samples = 10;
};

struct LogColumn {
  std::string quantity;        // "force"
  std::string unit;            // "N": the values' SI unit
  std::string name;            // in the header
  std::size_t number = 0;      // number in the header, from 1
  std::vector<double> values;  // one for each sample, all finite
};

// A log with checked samples: finite, and over a time that grows.
struct Log {
  std::string file;  // name in errors
  std::size_t samples = 0;
  std::vector<double> time;  // s; empty for a list
  std::vector<LogColumn> columns;
  Spacing spacing;                      // of the time; not set for a list
  std::vector<std::string> left_aside;  // names of the columns that are not read
  // Warnings, one line each, with the file: repairs, and doubtful values.
  std::vector<std::string> warnings;

  const LogColumn* find(std::string_view quantity) const;
  // Throws InputError with the names that would do where there is none in this unit.
  const LogColumn& column(std::string_view quantity, std::string_view si) const;
};

// Reads a CSV file (csv.h) whose columns are named after quantities and units: time_s,
// force_mN, angle_deg, position_counts, bytes, count. A double a value is what it takes of the
// memory. A file that is separated by semicolons or tabs may have decimal commas.
//
// Repaired, with a warning: empty rows before and behind the samples; a row that repeats the one
// before, time included; a decimal comma; times that stray from even spacing by less than half
// the period, and a tenth of it rms; times in whole units whose steps of two are rounding. Warned
// of: gaps, of which `spacing.stretches` has the sides; a constant column; a log that is not evenly
// spaced.
//
// A sample rate counts for more than a time that is uneven, does not grow or has another rate.
//
// Throws InputError, one line with the file and where it applies line and column: no time and no
// sample rate; a time that does not grow; a cell that is empty or no finite
// number; a row of more or fewer fields than the header; two columns of a quantity; a column that
// `columns` names and the header does not have; counts of an unknown size; fewer samples than
// `least_samples`.
Log read_log(const std::filesystem::path& file, const LogOptions& options = {});
// The same for a text; `name` is the file's name in errors.
Log read_log(std::istream& in, const std::string& name, const LogOptions& options = {});

}  // namespace hvp::files
