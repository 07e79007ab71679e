#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "models/fit/qlv_problem.h"
#include "models/fit/qlv_response.h"
#include "models/tissue/prony.h"

namespace hvp::fit {

// The force (N) at each sample of a QLV fit with Fung's elastic force and two exponentials, by the
// recursion over frames, of which so many make a step of the log.
inline std::vector<double> fung_in_frames(const PressedLog& log, const std::vector<double>& values,
                                          int frames) {
  const std::vector<tissue::PronyTerm> terms = {{.share = values[2], .time_s = values[3]},
                                                {.share = values[4], .time_s = values[5]}};
  tissue::PronyForces<double> memory(tissue::PronySeries(terms, log.step / frames), 1);
  const FungElasticity<double> elasticity{values[0], values[1]};
  const double contact = std::max(log.direction * values[6], log.shallowest());
  std::vector<double> forces = {values[7]};
  for (std::size_t i = 1; i < log.time.size(); ++i) {
    double force = 0;
    for (int n = 1; n <= frames; ++n) {
      const double depth = log.depth[i - 1] + (log.depth[i] - log.depth[i - 1]) * n / frames;
      const double elastic = elasticity.force(std::max(0.0, depth - contact));
      memory.forces({&elastic, 1}, {&force, 1});
      memory.commit({&elastic, 1});
    }
    forces.push_back(force + values[7]);
  }
  return forces;
}

}  // namespace hvp::fit
