// The reader of logs on arbitrary bytes, as a log over time, as a list, with a map of columns and
// with a sample rate. What must hold: it throws nothing but an InputError of one line, and what it
// accepts is finite, grows in time and has a value a sample in every column.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "models/config/input_error.h"
#include "models/files/log_table.h"

namespace {

using hvp::files::Log;
using hvp::files::LogOptions;

void require(bool holds) {
  if (!holds) std::abort();
}

void require_one_line(std::string_view line) {
  require(!line.empty() && line.size() < 2000);
  require(std::none_of(line.begin(), line.end(),
                       [](char c) { return static_cast<unsigned char>(c) < 0x20; }));
}

void require_sound(const Log& log, const LogOptions& options, std::size_t bytes) {
  require(log.samples >= options.least_samples && log.samples <= bytes);
  for (const auto& column : log.columns) {
    require(column.values.size() == log.samples);
    require(std::ranges::all_of(column.values, [](double v) { return std::isfinite(v); }));
  }
  for (const std::string& warning : log.warnings) require_one_line(warning);
  if (!options.over_time) return;
  require(log.time.size() == log.samples);
  std::size_t next = 0;
  for (const auto& stretch : log.spacing.stretches) {
    require(stretch.begin == next && stretch.end > stretch.begin);
    next = stretch.end;
  }
  require(next == log.samples);
  // Behind a repair two samples may share a time that their doubles cannot tell apart.
  require(std::ranges::is_sorted(log.time));
}

void read(const std::string& text, const LogOptions& options) {
  std::istringstream in(text);
  try {
    const Log log = hvp::files::read_log(in, "x\ny.csv", options);
    require_sound(log, options, text.size());
    log.column("force", "N");
  } catch (const hvp::InputError& error) {
    require_one_line(error.what());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  read(text, {.count_size = 1e-3, .least_samples = 2});
  read(text, {.quantities = {"force"}, .columns = {"time_ms=t", "force_N=2"}, .least_samples = 3});
  read(text, {.columns = {"force_N=1"}, .sample_rate = 1e3, .count_size = 1.0});
  read(text, {.over_time = false, .least_samples = 1});
  return 0;
}
