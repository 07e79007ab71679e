#pragma once

#include <cstdint>

#include "models/fixed/quantised_matrix.h"
#include "models/fixed/settings.h"
#include "vp/fpga/engine/cycle_engine.h"
#include "vp/fpga/engine/phase_engine.h"

namespace hvp::test {

// Clocks of one solve at the three levels; the cycle-accurate engine is the measure.
struct Levels {
  std::int64_t cycle_accurate = 0;
  std::int64_t approximately_timed = 0;
  std::int64_t loosely_timed = 0;

  double approximate_error() const { return percent(approximately_timed); }
  double loose_error() const { return percent(loosely_timed); }

 private:
  double percent(std::int64_t clocks) const {
    return 100.0 * static_cast<double>(clocks - cycle_accurate) /
           static_cast<double>(cycle_accurate);
  }
};

// Of a matrix and a right-hand side of random words up to `rhs`; runs the simulation until both
// engines, which have the same architecture, are done.
Levels compare(vp::engine::CycleEngine& cycles, vp::engine::PhaseEngine& phases,
               const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings,
               std::int32_t rhs = 2000);

}  // namespace hvp::test
