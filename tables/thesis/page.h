#pragma once

#include <string>

namespace hvp::tables {

// docs/thesis-tables.md.
std::string thesis_page();

// What is plotted: "series,iterations,error_rounded,error_true" with every fifth iteration; the
// thesis' own columns have no error_true.
std::string thesis_csv();

}  // namespace hvp::tables
