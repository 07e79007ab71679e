#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace hvp::files {

// How the name of a log's column writes a unit: 1 unit = factor · 10^exponent SI units.
struct LogUnit {
  std::string_view suffix;  // behind an underscore: "mN"
  std::string_view si;      // "N"; "count" of what has a resolution of its own
  int exponent;
  double factor = 1;
};

struct LogName {
  std::string quantity;  // "force"
  const LogUnit* unit = nullptr;
};

// "force_mN" -> force in mN; "bytes" is a size and "count" a number. Nothing for a name without
// one of the units.
std::optional<LogName> log_name(std::string_view column);

// All of `text` in SI units, as decimal_number() reads it.
std::optional<double> in_si(std::string_view text, const LogUnit& unit);

// The names that a column of the quantity in this SI unit may have: "force_N, force_mN or
// force_kN".
std::string log_names(std::string_view quantity, std::string_view si);

}  // namespace hvp::files
