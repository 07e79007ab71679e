#include "models/files/log_rows.h"

#include <cmath>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "models/files/log_columns.h"
#include "models/files/one_line.h"

namespace hvp::files {
namespace {

// "1,5" -> "1.5"; nothing where the text has not one comma and no point.
std::optional<std::string> with_decimal_point(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos || text.find_first_of(",.", comma + 1) != text.npos ||
      text.find('.') < comma) {
    return {};
  }
  std::string result(text);
  result[comma] = '.';
  return result;
}

}  // namespace

std::string shown(const LogColumn& column) {
  return fmt::format("column {} ({})", column.number, one_line(column.name, 60));
}

std::string at_line(const std::string& file, std::size_t line, const std::string& what) {
  return fmt::format("{}:{}: {}", file, line, what);
}

LogRows::LogRows(std::istream& in, const std::string& name, const LogOptions& options)
    : options_(options),
      table_(in, one_line(name)),
      chosen_(choose_columns(table_, options)),
      row_(chosen_.columns.size()) {
  const LogName& first = chosen_.columns.front().name;
  has_time_ = options.over_time && first.quantity == "time" && first.unit->si == "s";
}

void LogRows::read(Log& log) {
  name_columns(log);
  while (table_.next_of_any_length()) take_row(log);
  for (LogColumn& column : log.columns) column.values.shrink_to_fit();
  say_repairs(log);
}

void LogRows::name_columns(Log& log) const {
  log.file = table_.name();
  log.left_aside = chosen_.left_aside;
  for (const LogChoice::Column& column : chosen_.columns) {
    const bool counts = column.name.unit->si == "count";
    log.columns.push_back({column.name.quantity,
                           counts ? options_.count_unit : std::string(column.name.unit->si),
                           table_.columns()[column.index],
                           column.index + 1,
                           {}});
  }
}

InputError LogRows::wrong(const std::string& what) const {
  return InputError(at_line(table_.name(), table_.line(), what));
}

void LogRows::take_row(Log& log) {
  if (is_empty_row()) {
    if (log.samples == 0) {
      empty_above_.note(table_.line());
    } else if (first_empty_ == 0) {
      first_empty_ = table_.line();
    }
    return;
  }
  if (first_empty_ != 0) {
    throw InputError(
        at_line(log.file, first_empty_, "an empty row amid the samples: expected numbers"));
  }
  require_fields();
  for (std::size_t i = 0; i < row_.size(); ++i) row_[i] = value(i, log);
  if (has_time_ && log.samples > 0 && !goes_on(log)) return;
  for (std::size_t i = 0; i < row_.size(); ++i) log.columns[i].values.push_back(row_[i]);
  lines_.add(log.samples++, table_.line());
}

bool LogRows::is_empty_row() const {
  for (std::size_t i = 0; i < table_.fields(); ++i) {
    if (!table_.text(i).empty()) return false;
  }
  return true;
}

void LogRows::require_fields() const {
  const std::size_t expected = table_.columns().size();
  if (table_.fields() == expected) return;
  const bool comma = table_.delimiter() == ',' && table_.fields() > expected;
  throw wrong(
      fmt::format("{} fields, the header has {}{}", table_.fields(), expected,
                  comma ? ": where commas are decimal, expected ; between the columns" : ""));
}

double LogRows::value(std::size_t i, const Log& log) {
  const LogChoice::Column& column = chosen_.columns[i];
  const std::string_view text = table_.text(column.index);
  const double count = column.name.unit->si == "count" ? options_.count_size.value_or(1) : 1;
  std::optional<double> number = in_si(text, *column.name.unit);
  if (!number) {
    if (const auto repaired = with_decimal_point(text)) {
      number = in_si(*repaired, *column.name.unit);
      if (number) comma_.note(table_.line());
    }
  }
  if (number) *number *= count;
  if (!number || !std::isfinite(*number)) {
    throw wrong(fmt::format("{} is {}, expected a finite number", shown(log.columns[i]),
                            text.empty() ? "empty" : "'" + one_line(text, 40) + "'"));
  }
  return *number;
}

bool LogRows::goes_on(const Log& log) {
  // With a rate the time is not needed.
  if (options_.sample_rate) return true;
  const double before = log.columns.front().values.back();
  if (row_.front() > before) {
    just_repeated_ = false;
    return true;
  }
  bool same = true;
  for (std::size_t i = 0; i < row_.size(); ++i) {
    same = same && row_[i] == log.columns[i].values.back();
  }
  if (same && !just_repeated_) {
    just_repeated_ = true;
    repeated_.note(table_.line());
    return false;
  }
  const bool equal = row_.front() == before;
  throw wrong(fmt::format("{} {} {} s{}: expected more than in the row before",
                          shown(log.columns.front()), equal ? "repeats" : "goes back to",
                          row_.front(),
                          equal ? (same ? " a second time" : " with other values")
                                : fmt::format(" from {} s", before)));
}

void LogRows::say_repairs(Log& log) const {
  const auto warn = [&log](std::size_t line, const std::string& what) {
    log.warnings.push_back(at_line(log.file, line, what));
  };
  const auto others = [](const Repair& repair, const char* what) {
    return repair.times == 1 ? std::string()
                             : fmt::format(", as are {} further {}", repair.times - 1, what);
  };
  if (empty_above_.times > 0) {
    warn(empty_above_.first_line, "empty rows before the samples are left out");
  }
  if (comma_.times > 0) {
    warn(comma_.first_line, "a decimal comma is read as a point" + others(comma_, "cells"));
  }
  if (repeated_.times > 0) {
    warn(repeated_.first_line,
         "repeats the row before and is left out" + others(repeated_, "rows"));
  }
  if (first_empty_ != 0) warn(first_empty_, "empty rows behind the samples are left out");
}

}  // namespace hvp::files
