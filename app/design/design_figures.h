#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/accel/board.h"
#include "models/accel/critical_path.h"
#include "models/accel/memory.h"
#include "models/accel/operations.h"
#include "models/accel/partition.h"
#include "models/accel/variations.h"

namespace hvp::app {

class Scene;

// The result of a design with one number changed.
struct WhatIf {
  accel::Variation variation;
  std::int64_t solve_clocks = 0;
  std::optional<double> highest_clock_hz;  // absent: the device's file has no [timing]
  double solve_s = 0;  // at the scenario's clock, or at the highest where that is lower
  std::vector<std::string> short_of;  // "M4K 285 of 255"; empty: it fits
  std::string refused;                // why there is no such design for this mesh; empty: there is
};

// The size of a mesh, and the rates at which it can be solved.
struct Reach {
  int nodes = 0;       // of the system
  int mesh_nodes = 0;  // as object.mesh.nodes counts them
  std::int64_t solve_ps = 0;
  std::int64_t frame_ps = 0;  // the sum of the frame's large steps by annotated costs

  double solve_rate_hz() const;  // solves without a pause
  double frame_rate_hz() const;
};

// Everything that `hvp device` prints. The scene's mesh may be too large for its device, and the
// clock too fast.
struct DesignFigures {
  accel::SolveCycles cycles;
  std::optional<accel::CriticalPath> clock;  // absent: the device's file has no [timing]
  accel::Usage usage;
  accel::Packing packing;
  accel::OperationRate operations;
  Reach scene;
  std::optional<Reach> largest;  // the largest mesh with such rows that fits; absent: none fits
  std::vector<WhatIf> what_if;

  bool clock_is_reached(const accel::Architecture& a) const {
    return !clock || a.clock_hz <= clock->highest_clock_hz;
  }
};
DesignFigures design_figures(const Scene& scene);

}  // namespace hvp::app
