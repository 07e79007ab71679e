#pragma once

#include <array>
#include <cstdint>

#include "models/accel/cycles.h"
#include "vp/fpga/accelerator.h"

namespace hvp::results {

// Clocks of a phase of a solve as the engine took them, and by the closed form of
// docs/accelerator.md for the same work.
struct PhaseClocks {
  const char* name = "";  // as summary.json has it
  const char* title = "";
  std::int64_t engine = 0;
  std::int64_t closed_form = 0;
};

// The longest solve of a run at a level that has an engine.
struct EngineClocks {
  std::int64_t engine = 0;
  std::int64_t closed_form = 0;
  std::int64_t iterations = 0;
  std::array<PhaseClocks, 7> phases{};

  // Of the closed form from the engine.
  double deviation() const {
    return static_cast<double>(closed_form - engine) / static_cast<double>(engine);
  }
};

// The phases of each sum to its clocks. `closed_form` is that of solve.work.
EngineClocks engine_clocks(const vp::EngineSolve& solve, const accel::SolveCycles& closed_form);

}  // namespace hvp::results
