#pragma once

#include <string>

namespace hvp::tables {

// docs/partitions.md.
std::string partitions_page();

}  // namespace hvp::tables
