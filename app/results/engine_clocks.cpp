#include "app/results/engine_clocks.h"

#include <cstddef>
#include <initializer_list>

namespace hvp::results {

EngineClocks engine_clocks(const vp::EngineSolve& solve, const accel::SolveCycles& c) {
  using vp::engine::State;
  const auto spent = [&solve](std::initializer_list<State> states) {
    std::int64_t clocks = 0;
    for (const State state : states) clocks += solve.state[static_cast<std::size_t>(state)];
    return clocks;
  };
  const std::int64_t set_up =
      spent({State::guess, State::start_product, State::start_residual, State::first_direction});
  const std::int64_t product = spent({State::product});
  const std::int64_t update = spent({State::update});
  const std::int64_t direction = spent({State::direction});
  const std::int64_t divisions = spent({State::alpha, State::beta});
  const std::int64_t anew = spent({State::anew_product, State::anew_residual});
  const std::int64_t waited =
      solve.clocks - set_up - product - update - direction - divisions - anew;
  const std::int64_t n = c.iterations;
  EngineClocks clocks{solve.clocks, c.total(), n, {}};
  clocks.phases = {
      {{"wait", "waiting for the copy of U", waited, 0},
       {"set_up", "set-up", set_up, c.setup},
       {"product", "product and inner product", product, n * c.sparse_product + c.breakdown},
       {"update", "solution and residual", update, n * c.update},
       {"direction", "direction", direction, n * c.direction},
       {"divisions", "divisions", divisions, n * c.divisions},
       {"residual_anew", "residuals formed anew", anew, c.replacements * c.replacement}}};
  return clocks;
}

}  // namespace hvp::results
