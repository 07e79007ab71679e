#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/fixed/settings.h"
#include "models/stability/flag.h"

namespace hvp::fixed {

// How a system is solved, as far as a remedy may change it.
struct Plan {
  Settings settings;
  // Solves of a frame: between them the host forms b - A·x in double precision and the board
  // solves for the increment. 1: no refinement.
  int passes = 1;

  friend bool operator==(const Plan&, const Plan&) = default;
};

// What the host knows of the size of the displacements, for the range that they are given.
struct Extent {
  double largest_displacement = 0;  // m; 0: unknown
};

// One change of a plan.
struct Remedy {
  stability::Flag flag = stability::Flag::count;  // that it is for
  Plan plan;
  std::string change;  // "solver.matrix_bits = 16, solver.vector_bits = 20"
};

// The remedy for what a solve with that plan has raised. Of several flags the cause is treated
// before what follows from it, and each flag's remedies are tried in the order in which its text
// names them (stability::describe): first what costs no time in a frame, then time, then words,
// which cost the device. Gives the first change that is not in force yet; none where all are, or
// where no setting of the board helps. Followed again and again it ends after a few dozen steps.
std::optional<Remedy> next_remedy(stability::Flags flags, const Plan& plan,
                                  const Extent& extent = {});

// What a plan has changed of another: "solver.iterations = 160, host.refinement.passes = 2".
std::string difference(const Plan& from, const Plan& to);

}  // namespace hvp::fixed
