#include "tests/vp/engine/levels.h"

#include <gtest/gtest.h>

#include "models/accel/cycles.h"
#include "tests/vp/engine/engine_systems.h"

namespace hvp::test {

Levels compare(vp::engine::CycleEngine& cycles, vp::engine::PhaseEngine& phases,
               const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings,
               std::int32_t rhs) {
  cycles.load(matrix, settings);
  cycles.write_b(random_words(matrix.rows(), rhs, 3));
  cycles.start_solve(settings);
  sc_core::sc_start();
  phases.load(matrix, settings);
  phases.start_solve(settings, cycles.report());
  sc_core::sc_start();
  EXPECT_TRUE(cycles.idle() && phases.idle());
  const accel::SolveCycles closed_form =
      accel::solve_cycles(cycles.architecture(), accel::pattern_of(matrix.row_begin, matrix.column),
                          accel::solve_made(settings, cycles.report()));
  return {cycles.clocks(), phases.clocks(), closed_form.total()};
}

}  // namespace hvp::test
