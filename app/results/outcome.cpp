#include "app/results/outcome.h"

#include <algorithm>

namespace hvp::results {

bool Outcome::held() const {
  return force_in_time && load_held &&
         std::ranges::all_of(error_budgets, [](const ErrorBudget& b) { return b.held(); });
}

bool Outcome::accuracy_measured() const {
  // A few of many frames say nothing of the rest.
  constexpr std::int64_t kEnough = 16;
  if (!accuracy || !accuracy->displacement.of_frame) return false;
  return accuracy->displacement.of_frame->frames >= std::min(kEnough, accuracy->in_contact);
}

}  // namespace hvp::results
