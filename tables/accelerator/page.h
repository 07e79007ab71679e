#pragma once

#include <string>

namespace hvp::tables {

// docs/accelerator-tables.md: Tables 5.1, 6.1, 6.2 and 6.4 of the thesis beside what the model
// gives.
std::string accelerator_page();

}  // namespace hvp::tables
