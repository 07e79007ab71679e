#include "tables/hard_cases/accuracy.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "models/host/deviation.h"

namespace hvp::tables {

double largest_magnitude(std::span<const double> v) {
  double result = 0;
  for (const double entry : v) result = std::max(result, std::abs(entry));
  return result;
}

double relative_error(std::span<const double> u, std::span<const double> exact) {
  constexpr double kLeastNormal = std::numeric_limits<double>::min();
  const double size = largest_magnitude(exact);
  if (size < kLeastNormal) {
    return largest_magnitude(u) < kLeastNormal ? 0 : std::numeric_limits<double>::infinity();
  }
  double of_gap = 0;
  double of_exact = 0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double reference = exact[i] / size;
    const double gap = u[i] / size - reference;
    of_gap += gap * gap;
    of_exact += reference * reference;
  }
  return std::sqrt(of_gap / of_exact);
}

stability::Flags flags_of_errors(const CaseOutcome& outcome, const fixed::Plan& plan) {
  if (plan.passes == 1) {
    host::Reference bounds;
    bounds.tolerance = kBound;
    bounds.solver_tolerance = kBound;
    return host::accuracy_flags(bounds, outcome.error_true, outcome.error_rounded);
  }
  // A refined solution is that of the true model: what is left of its error is the passes'.
  stability::Flags flags;
  if (!(outcome.error_true <= kBound)) flags.raise(stability::Flag::not_converged);
  return flags;
}

}  // namespace hvp::tables
