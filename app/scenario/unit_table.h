#pragma once

#include <span>
#include <string_view>

#include "models/config/declaration.h"

namespace hvp::scenario {

// One spelling of a unit: 1 unit = factor · 10^exponent SI units, `factor` a whole number in
// decimal digits, so that the product with a decimal number is exact.
struct Unit {
  enum class Use {
    read_and_write,  // format_quantity may choose it
    read,            // admitted, never written
    spelling,        // another way to write the unit before it
  };
  std::string_view name;
  std::string_view factor;
  int exponent;
  Use use;
};

struct DimensionUnits {
  config::Dimension dimension;
  std::string_view name;     // with its article
  std::string_view example;  // a typical text
  std::span<const Unit> units;
};

const DimensionUnits& units_table(config::Dimension dimension);
std::span<const DimensionUnits> all_dimensions();

}  // namespace hvp::scenario
