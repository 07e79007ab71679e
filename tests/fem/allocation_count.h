#pragma once

#include <cstddef>

namespace hvp::fem {

// Calls of operator new in this program so far.
std::size_t allocation_count();

}  // namespace hvp::fem
