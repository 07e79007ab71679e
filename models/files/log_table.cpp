#include "models/files/log_table.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/files/log_columns.h"
#include "models/files/log_rows.h"
#include "models/files/one_line.h"
#include "models/files/regular_file.h"

namespace hvp::files {
namespace {

constexpr double kRateTolerance = 0.01;
constexpr std::size_t kMostGapsNamed = 5;

class LogReader {
 public:
  LogReader(std::istream& in, const std::string& name, const LogOptions& options)
      : options_(options), rows_(in, name, options) {}

  Log read() {
    rows_.read(log_);
    if (rows_.has_time()) {
      log_.time = std::move(log_.columns.front().values);
      log_.columns.erase(log_.columns.begin());
    }
    if (log_.samples < std::max<std::size_t>(options_.least_samples, 1)) {
      throw InputError(fmt::format("{}: {} samples, expected at least {}", log_.file, log_.samples,
                                   std::max<std::size_t>(options_.least_samples, 1)));
    }
    if (options_.over_time) find_spacing();
    say_constant_columns();
    return std::move(log_);
  }

 private:
  void warn(std::size_t line, const std::string& what) {
    log_.warnings.push_back(at_line(log_.file, line, what));
  }
  void warn_of_file(const std::string& what) {
    log_.warnings.push_back(fmt::format("{}: {}", log_.file, what));
  }

  void find_spacing() {
    if (!rows_.has_time()) {
      make_time();
      return;
    }
    if (log_.samples < 2) {
      log_.spacing.stretches = {{0, log_.samples}};
      return;
    }
    if (options_.sample_rate && !std::ranges::is_sorted(log_.time, std::less_equal<>())) {
      warn_of_file("its times do not grow: the samples are taken at the rate that is given");
      make_time();
      return;
    }
    log_.spacing = spacing_of(log_.time);
    Spacing& spacing = log_.spacing;
    const std::string strays = text_of_strays();
    if (options_.sample_rate && !takes_rate()) {
      warn(rows_.line_of(spacing.strays),
           strays + ": the samples are taken at the rate that is given");
      make_time();
      return;
    }
    say_gaps();
    if (spacing.rounded_to > 0) {
      warn_of_file(
          fmt::format("its times are whole multiples of {:.6g} s: steps of two are taken "
                      "for the rounding of a clock with a period of {:.6g} s",
                      spacing.rounded_to, spacing.period));
      space_evenly(log_.time, spacing);
      return;
    }
    if (!spacing.even) {
      warn(rows_.line_of(spacing.strays), strays + ": taken as it is");
    } else if (space_evenly(log_.time, spacing)) {
      warn(rows_.line_of(spacing.strays), strays + ": taken as even");
    }
  }

  void make_time() {
    const double period = 1 / *options_.sample_rate;
    log_.time.resize(log_.samples);
    for (std::size_t i = 0; i < log_.samples; ++i) {
      log_.time[i] = static_cast<double>(i) / *options_.sample_rate;
    }
    log_.spacing = {.period = period, .even = true, .stretches = {{0, log_.samples}}};
  }

  std::string text_of_strays() const {
    const Spacing& spacing = log_.spacing;
    if (!(spacing.jitter < std::numeric_limits<double>::infinity())) {
      return fmt::format("the time is not evenly spaced, {:.6g} s apart in the median",
                         spacing.period);
    }
    return fmt::format(
        "the time strays up to {:.3g} % of the period of {:.6g} s from even spacing, {:.2g} % rms",
        100 * spacing.jitter, spacing.period, 100 * spacing.rms);
  }

  // Gives an even time with that rate, but for a clock that is a little off, the rate. False where
  // the time is another one, which is then not used.
  bool takes_rate() {
    Spacing& spacing = log_.spacing;
    const double period = 1 / *options_.sample_rate;
    if (!spacing.even || std::abs(spacing.period / period - 1) > kRateTolerance) return false;
    spacing.period = period;
    return true;
  }

  void say_gaps() {
    const std::vector<Stretch>& stretches = log_.spacing.stretches;
    for (std::size_t i = 1; i < stretches.size() && i <= kMostGapsNamed; ++i) {
      const std::size_t behind = stretches[i].begin;
      const double before = log_.time[behind - 1];
      const double gap = log_.time[behind] - before;
      warn(rows_.line_of(behind),
           fmt::format("a gap of {:.6g} s after {:.6g} s at a period of {:.6g} s, samples missing: "
                       "{:.0f}; read in pieces",
                       gap, before, log_.spacing.period, gap / log_.spacing.period - 1));
    }
    if (stretches.size() > kMostGapsNamed + 1) {
      warn_of_file(fmt::format("has {} further gaps", stretches.size() - 1 - kMostGapsNamed));
    }
  }

  void say_constant_columns() {
    for (const LogColumn& column : log_.columns) {
      const auto [least, most] = std::ranges::minmax(column.values);
      // A number says something where it is the same too: that all transfers are writes.
      if (least < most || column.unit.empty()) continue;
      warn_of_file(fmt::format("{} is {:.6g} {} in all samples: nothing can be had from it",
                               shown(column), least, column.unit));
    }
  }

  const LogOptions& options_;
  LogRows rows_;
  Log log_;
};

}  // namespace

const LogColumn* Log::find(std::string_view quantity) const {
  const auto found = std::ranges::find(columns, quantity, &LogColumn::quantity);
  return found == columns.end() ? nullptr : &*found;
}

const LogColumn& Log::column(std::string_view quantity, std::string_view si) const {
  const LogColumn* found = find(quantity);
  if (found != nullptr && found->unit == si) return *found;
  const std::string names = log_names(quantity, si);
  if (found != nullptr) {
    throw InputError(fmt::format("{}: column {} ({}) is in {}: expected {}", file, found->number,
                                 one_line(found->name, 60), found->unit, names));
  }
  throw InputError(fmt::format(
      "{}: has no column {}: name it by --column {}=NAME; left aside: {}", file, names,
      names.substr(0, names.find_first_of(", ")),
      left_aside.empty() ? "none" : one_line(fmt::format("{}", fmt::join(left_aside, ", ")))));
}

Log read_log(std::istream& in, const std::string& name, const LogOptions& options) {
  return LogReader(in, name, options).read();
}

Log read_log(const std::filesystem::path& file, const LogOptions& options) {
  const std::string name = file.filename().string();
  std::ifstream in;
  try {
    in = open_regular_file(file, "a log in CSV");
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", one_line(name), error.what()));
  }
  return read_log(in, name, options);
}

}  // namespace hvp::files
