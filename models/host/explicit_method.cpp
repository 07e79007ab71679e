#include "models/host/explicit_method.h"

#include <stdexcept>

#include <fmt/format.h>

namespace hvp::host {

void ExplicitMethod::go_on(std::span<const double> /*f*/, double /*way*/) {
  throw std::logic_error("explicit steps do not go on with another load");
}

bool ExplicitMethod::next(std::span<std::int32_t> /*b*/) {
  const fem::StepsFound found = steps_.step();
  operations_ = found.operations;
  if (found.inverted > 0) flags_.raise(stability::Flag::inverted_element);
  if (found.overflown > 0) flags_.raise(stability::Flag::energy_overflow);
  if (found.over_limit) flags_.raise(stability::Flag::unstable_step);
  return false;
}

std::vector<Step> ExplicitMethod::steps() const {
  return {{fmt::format("explicit steps, {} a frame (without contact)", steps_.substeps()),
           Step::Where::solver, 0, 1, false, SolveWork{.sparse = steps_.step_operations()}}};
}

}  // namespace hvp::host
