#pragma once

#include <string>
#include <vector>

#include "models/host/processor.h"
#include "models/host/solve_work.h"

namespace hvp::fit {

// A solve whose time was measured.
struct SolveTime {
  std::string solver;  // its name, as host.solver has it, and "single" where it computes so
  int unknowns = 0;
  host::SolveWork work;
  double working_set = 0;  // bytes
  double seconds = 0;
  bool held_out = false;  // predicted, and not fitted
};

// What the fitted processor predicts of a measured solve.
struct SolvePrediction {
  double seconds = 0;
  double ratio = 1;  // of the predicted time to the measured one
};

struct ProcessorFit {
  host::Processor processor;
  std::vector<SolvePrediction> predictions;  // of all times, in their order
  // |ln ratio| at its largest, as a factor: of those that were fitted, and of those held out.
  double worst_fitted = 1;
  double worst_held_out = 1;
};

// The rates and bandwidths of a processor with these caches, of which the last may have less room
// than its size, from times of solves: the least
// squares of ln(predicted / measured), by Ceres, so that a short solve counts as much as a long
// one. Where no time tells a figure apart it stays near the start's. Throws InputError for fewer
// than eight times that are fitted, or one that is not positive.
ProcessorFit fit_processor(const std::vector<SolveTime>& times, const host::Processor& start);

}  // namespace hvp::fit
