#include "models/fem/materials.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "models/index.h"

namespace hvp::fem {

Materials::Materials(std::vector<Material> table, std::vector<int> of_element)
    : table_(std::move(table)), of_element_(std::move(of_element)) {
  if (table_.empty()) throw std::invalid_argument("a body without a material");
  const bool known = std::ranges::all_of(
      of_element_, [this](int index) { return index >= 0 && at(index) < table_.size(); });
  if (!known) throw std::invalid_argument("an element of a material that is not in the table");
}

void Materials::check(std::size_t elements) const {
  for (const Material& material : table_) material.check();
  if (!of_element_.empty() && of_element_.size() != elements) {
    throw std::invalid_argument(
        fmt::format("the materials of {} elements for a mesh of {}", of_element_.size(), elements));
  }
}

std::vector<Lame> lame_constants(std::span<const Material> table) {
  std::vector<Lame> constants;
  constants.reserve(table.size());
  for (const Material& material : table) {
    constants.push_back({material.lame_lambda(), material.lame_mu()});
  }
  return constants;
}

}  // namespace hvp::fem
