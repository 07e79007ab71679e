#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>

#include "models/config/declaration.h"

namespace hvp::scenario {

// Values in TOML as a scenario writes them. Reading the text restores the same bits.
std::string toml_string(std::string_view text);
std::string toml_quantity(double value, config::Dimension dimension);
std::string toml_vector(const Eigen::Vector3d& value, config::Dimension dimension);

// The range in words: "from 1 kHz to 33 MHz", "more than 0 s", "at least 0 s"; empty if unbounded.
std::string range_text(const config::Range& range, config::Dimension dimension);
std::string range_text(const config::IntegerRange& range);
bool contains(const config::Range& range, double value);

}  // namespace hvp::scenario
