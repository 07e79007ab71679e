#include "app/solve/solve_settings.h"

#include <string>

#include "models/config/input_error.h"

namespace hvp::app {

SolveSettings::SolveSettings() {
  solver.method = fixed::Method::jacobi_pcg;
  solver.start = fixed::Start::zero;
  accelerator.partitions = 4;
}

void SolveSettings::choose_preconditioner_memory(const accel::Device& device) {
  const std::string small = "M512";
  if (device.memory(small) != nullptr) accelerator.preconditioner_memory = small;
}

void SolveSettings::declare(config::Visitor& v) {
  v.table("solver", solver, {"method and words of the fixed-point solver"});
  v.effect("refinement", refinement,
           {"the host forms the residual in double precision and the board solves for the "
            "increment, in several passes"});
  v.table("accelerator", accelerator, {"the FPGA's micro-architecture"});
  v.effect("spectrum", spectrum, {"bounds the extreme eigenvalues and the condition number"});
}

void SolveSettings::check() const {
  if (solver.start == fixed::Start::zero) return;
  throw InputError("solver.start", "there is no earlier solution to start from: expected zero");
}

}  // namespace hvp::app
