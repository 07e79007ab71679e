#pragma once

#include <string>

namespace hvp::tables {

// Thesis Table 6.3 with a row of this machine, measured in about a second. Not the same twice.
std::string pc_table();

}  // namespace hvp::tables
