#pragma once

#include <cstddef>
#include <limits>
#include <string_view>
#include <vector>

namespace hvp::files {

// The first cells of a line of a CSV file, which its commas part, at most `most` of them: at least
// one, views into `line`. No quoting, as no file that the house reads or writes has a comma inside
// a cell.
std::vector<std::string_view> csv_cells(std::string_view line,
                                        std::size_t most = std::numeric_limits<std::size_t>::max());

}  // namespace hvp::files
