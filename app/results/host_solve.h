#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "models/config/figures.h"

namespace hvp::app {
class Scene;
}  // namespace hvp::app

namespace hvp::results {

// Of the host's own solve, where there is no board.
struct HostSolveFigures {
  std::string precision;
  std::string model;  // whose figures price it
  double memory_bytes = 0;
  double working_set_bytes = 0;
  double operations = 0;  // of a solve without contact
  double bytes = 0;       // that it moves
  std::int64_t solve_ps = 0;
  std::int64_t rest_ps = 0;  // after the force
  std::int64_t set_up_ps = 0;

  void report(config::Figures& f) const;
};

// Empty where the board solves. The scene has a body.
std::optional<HostSolveFigures> host_solve_figures(const app::Scene& scene);

}  // namespace hvp::results
