#pragma once

#include <cstddef>

namespace hvp::test {

// How often this program has called operator new.
std::size_t allocation_count();

}  // namespace hvp::test
