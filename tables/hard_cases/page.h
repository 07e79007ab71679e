#pragma once

#include <string>

namespace hvp::tables {

// docs/hard-cases.md: every hard case followed to its end.
std::string hard_cases_page();

}  // namespace hvp::tables
