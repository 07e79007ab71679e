#include "models/files/csv.h"

namespace hvp::files {

std::vector<std::string_view> csv_cells(std::string_view line, std::size_t most) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = line.find(',', begin);
    cells.push_back(line.substr(begin, comma - begin));
    if (comma == std::string_view::npos || cells.size() == most) return cells;
    begin = comma + 1;
  }
}

}  // namespace hvp::files
