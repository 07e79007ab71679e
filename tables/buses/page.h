#pragma once

#include <string>

namespace hvp::tables {

// docs/bus-tables.md: what links carry, what the ways to move a frame's data cost, and what a
// second master adds.
std::string buses_page();

}  // namespace hvp::tables
