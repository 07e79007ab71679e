#include "models/files/log_columns.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/files/csv.h"
#include "models/files/one_line.h"

namespace hvp::files {

namespace {

constexpr auto kUnits = std::to_array<LogUnit>({
    {"s", "s", 0},
    {"ms", "s", -3},
    {"us", "s", -6},
    {"\u00b5s", "s", -6},  // the micro sign, which Unicode has twice
    {"\u03bcs", "s", -6},
    {"ns", "s", -9},
    {"min", "s", 0, 60},
    {"m", "m", 0},
    {"cm", "m", -2},
    {"mm", "m", -3},
    {"um", "m", -6},
    {"\u00b5m", "m", -6},
    {"\u03bcm", "m", -6},
    {"nm", "m", -9},
    {"m_s", "m/s", 0},
    {"mm_s", "m/s", -3},
    {"rad", "rad", 0},
    {"mrad", "rad", -3},
    {"deg", "rad", 0, std::numbers::pi / 180},
    {"rad_s", "rad/s", 0},
    {"deg_s", "rad/s", 0, std::numbers::pi / 180},
    {"N", "N", 0},
    {"mN", "N", -3},
    {"uN", "N", -6},
    {"kN", "N", 3},
    {"Nm", "N m", 0},
    {"mNm", "N m", -3},
    {"N_m", "N m", 0},
    {"mN_m", "N m", -3},
    {"A", "A", 0},
    {"mA", "A", -3},
    {"V", "V", 0},
    {"mV", "V", -3},
    {"Pa", "Pa", 0},
    {"kPa", "Pa", 3},
    {"bytes", "B", 0},
    {"B", "B", 0},
    {"kB", "B", 3},
    {"KiB", "B", 0, 1024},
    {"MB", "B", 6},
    {"MiB", "B", 0, 1024.0 * 1024.0},
    {"B_s", "B/s", 0},
    {"MB_s", "B/s", 6},
    {"GB_s", "B/s", 9},
    {"counts", "count", 0},
});

constexpr LogUnit kNumber = {"", "", 0};

const LogUnit& unit_called(std::string_view suffix) {
  return *std::ranges::find(kUnits, suffix, &LogUnit::suffix);
}

}  // namespace

std::optional<LogName> log_name(std::string_view column) {
  if (column == "bytes") return LogName{"size", &unit_called("bytes")};
  if (column == "count") return LogName{"count", &kNumber};
  constexpr std::string_view kOfNumber = "_count";
  if (column.size() > kOfNumber.size() && column.ends_with(kOfNumber)) {
    return LogName{std::string(column.substr(0, column.size() - kOfNumber.size())), &kNumber};
  }
  // The longest: velocity_m_s is no velocity_m in seconds.
  const LogUnit* longest = nullptr;
  for (const LogUnit& unit : kUnits) {
    const std::size_t length = unit.suffix.size();
    const bool has_it = column.size() > length + 1 && column.ends_with(unit.suffix) &&
                        column[column.size() - length - 1] == '_';
    if (has_it && (longest == nullptr || length > longest->suffix.size())) longest = &unit;
  }
  if (longest == nullptr) return {};
  return LogName{std::string(column.substr(0, column.size() - longest->suffix.size() - 1)),
                 longest};
}

std::optional<double> in_si(std::string_view text, const LogUnit& unit) {
  const std::optional<double> number = decimal_number(text, unit.exponent);
  if (!number || unit.factor == 1) return number;
  const double value = *number * unit.factor;
  if (!std::isfinite(value)) return {};
  return value;
}

std::string log_names(std::string_view quantity, std::string_view si) {
  std::vector<std::string> names;
  for (const LogUnit& unit : kUnits) {
    const bool ascii = std::ranges::all_of(
        unit.suffix, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
    if (unit.si == si && ascii) names.push_back(fmt::format("{}_{}", quantity, unit.suffix));
  }
  if (names.empty()) return std::string(quantity);
  const std::string last = names.back();
  names.pop_back();
  return names.empty() ? last : fmt::format("{} or {}", fmt::join(names, ", "), last);
}

namespace {

constexpr std::string_view kTime = "time";

std::string listed(const std::vector<std::string>& names) {
  return one_line(fmt::format("{}", fmt::join(names, ", ")));
}

std::optional<std::size_t> whole_number(std::string_view text) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return number;
}

class Chooser {
 public:
  Chooser(const CsvTable& table, const LogOptions& options) : table_(table), options_(options) {}

  LogChoice choose() {
    require_positive(options_.sample_rate, "the sample rate in 1/s");
    require_positive(options_.count_size, "the resolution of a count");
    require_names();
    for (const std::string& entry : options_.columns) add_mapped(entry);
    const std::size_t mapped = choice_.columns.size();
    for (std::size_t index = 0; index < table_.columns().size(); ++index) add_named(index, mapped);
    require_time();
    require_values();
    require_count_size();
    return std::move(choice_);
  }

 private:
  InputError wrong(const std::string& what) const {
    return InputError(fmt::format("{}:{}: {}", table_.name(), table_.header_line(), what));
  }

  static void require_positive(const std::optional<double>& value, std::string_view what) {
    if (!value || (*value > 0 && std::isfinite(*value))) return;
    throw InputError(fmt::format("{}: expected more than 0, found {}", what, *value));
  }

  void require_names() const {
    const std::vector<std::string>& names = table_.columns();
    const bool numbers = std::ranges::all_of(
        names, [](const std::string& n) { return n.empty() || decimal_number(n); });
    if (!numbers) return;
    throw wrong(
        fmt::format("expected names of columns with units, such as time_s,force_N; found {}",
                    names.size() == 1 && names[0].empty() ? "none" : listed(names)));
  }

  // "force_N=Load"
  void add_mapped(const std::string& entry) {
    const std::size_t equals = entry.find('=');
    const std::optional<LogName> name =
        log_name(trimmed(std::string_view(entry).substr(0, equals)));
    if (!name || equals == std::string::npos) {
      throw InputError(fmt::format(
          "{}: expected a name with a unit and the header's, such as force_N=Load or force_N=2",
          in_quotes(entry)));
    }
    if (const std::size_t* twice = taken(name->quantity)) {
      throw InputError(fmt::format("{}: column {} gives the {} already", in_quotes(entry),
                                   *twice + 1, one_line(name->quantity, 60)));
    }
    choice_.columns.push_back(
        {index_of(trimmed(std::string_view(entry).substr(equals + 1))), *name});
  }

  std::size_t index_of(std::string_view column) const {
    const std::vector<std::string>& names = table_.columns();
    if (std::ranges::count(names, column) > 1) {
      throw wrong(fmt::format("several columns are called {}: name it by its number, from 1",
                              in_quotes(column)));
    }
    if (const std::optional<std::size_t> index = table_.find(column)) return *index;
    const std::optional<std::size_t> number = whole_number(column);
    if (number && *number >= 1 && *number <= names.size()) return *number - 1;
    throw wrong(fmt::format("has no column {}: expected one of {}, or a number from 1 to {}",
                            in_quotes(column), listed(names), names.size()));
  }

  // `mapped`: how many columns the options give; what is theirs does not count.
  void add_named(std::size_t index, std::size_t mapped) {
    const auto is_mapped = [&](const LogChoice::Column& c) { return c.index == index; };
    const auto end = choice_.columns.begin() + static_cast<std::ptrdiff_t>(mapped);
    if (std::any_of(choice_.columns.begin(), end, is_mapped)) return;
    const std::string& column = table_.columns()[index];
    const std::optional<LogName> name = log_name(column);
    const auto same = [&](const LogChoice::Column& c) { return c.name.quantity == name->quantity; };
    if (!name || !wanted(name->quantity) || std::any_of(choice_.columns.begin(), end, same)) {
      choice_.left_aside.push_back(column);
      return;
    }
    if (const std::size_t* other = taken(name->quantity)) {
      throw wrong(fmt::format("columns {} and {} both give the {}: choose one by --column {}_{}={}",
                              *other + 1, index + 1, one_line(name->quantity, 60),
                              one_line(name->quantity, 60), name->unit->suffix, index + 1));
    }
    choice_.columns.push_back({index, *name});
  }

  bool wanted(const std::string& quantity) const {
    const std::vector<std::string>& all = options_.quantities;
    return all.empty() || (options_.over_time && quantity == kTime) ||
           std::ranges::find(all, quantity) != all.end();
  }

  // The index of the column that gives it; valid until the next one is added.
  const std::size_t* taken(std::string_view quantity) const {
    const auto found = std::ranges::find_if(
        choice_.columns, [&](const LogChoice::Column& c) { return c.name.quantity == quantity; });
    return found == choice_.columns.end() ? nullptr : &found->index;
  }

  void require_time() {
    if (!options_.over_time) return;
    const auto time = std::ranges::find_if(choice_.columns, [](const LogChoice::Column& c) {
      return c.name.quantity == kTime && c.name.unit->si == "s";
    });
    if (time != choice_.columns.end()) {
      std::rotate(choice_.columns.begin(), time, time + 1);
    } else if (!options_.sample_rate) {
      throw wrong(
          fmt::format("has no column {}, and no sample rate is given: found {}; name it by "
                      "--column time_s=NAME",
                      log_names(kTime, "s"), listed(table_.columns())));
    }
  }

  void require_values() const {
    const auto is_value = [this](const LogChoice::Column& c) {
      return !options_.over_time || c.name.quantity != kTime;
    };
    if (std::ranges::any_of(choice_.columns, is_value)) return;
    const std::vector<std::string>& wanted = options_.quantities;
    throw wrong(fmt::format("has no column of {}, whose name ends in a unit: found {}",
                            wanted.empty() ? "a quantity beside the time" : listed(wanted),
                            listed(table_.columns())));
  }

  void require_count_size() const {
    for (const LogChoice::Column& column : choice_.columns) {
      if (column.name.unit->si != "count" || options_.count_size) continue;
      throw wrong(fmt::format("column {} ({}) is in counts: expected their resolution to be given",
                              column.index + 1, one_line(table_.columns()[column.index], 60)));
    }
  }

  const CsvTable& table_;
  const LogOptions& options_;
  LogChoice choice_;
};

}  // namespace

LogChoice choose_columns(const CsvTable& table, const LogOptions& options) {
  return Chooser(table, options).choose();
}

}  // namespace hvp::files
