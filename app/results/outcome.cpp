#include "app/results/outcome.h"

#include <algorithm>

namespace hvp::results {

bool Outcome::held() const {
  return force_in_time && load_held &&
         std::ranges::all_of(error_budgets, [](const ErrorBudget& b) { return b.held(); });
}

}  // namespace hvp::results
