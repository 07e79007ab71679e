#pragma once

#include <cstddef>

namespace hvp {

// An index of nodes, rows and elements, which are counted in int, as the standard containers take
// it. The caller has made sure that it is not negative.
constexpr std::size_t at(int index) { return static_cast<std::size_t>(index); }

}  // namespace hvp
