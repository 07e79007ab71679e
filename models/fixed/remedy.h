#pragma once

#include <functional>
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

// What the host knows of the size of the displacements, for the range that they are given, and what
// there is time for.
struct Extent {
  double largest_displacement = 0;  // m; 0: unknown
  int most_passes = 6;
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

// What a plan has changed of another, as a scenario has it: "solver.iterations = 160".
std::vector<std::string> changes(const Plan& from, const Plan& to);
// In one line: "solver.iterations = 160, refinement.passes = 2".
std::string difference(const Plan& from, const Plan& to);

// What an attempt with a plan came to.
struct Trial {
  bool refused = false;  // there is no such system, or it cannot be solved
  stability::Flags flags;
  bool cured() const { return !refused && flags.empty(); }
};
using Attempt = std::function<Trial(const Plan&)>;

// Remedies followed until no flag is left.
struct Search {
  Plan plan;  // the last one tried
  Trial last;
  std::vector<Remedy> remedies;
  int attempts = 0;
};

// Does what next_remedy() says of `first`, what `plan` has come to, and of what that comes to, in
// `most` attempts at most.
Search follow_remedies(const Plan& plan, const Trial& first, const Extent& extent,
                       const Attempt& attempt, int most);
// Takes back, one after the other, the changes without which a cured search is cured too: a remedy
// once taken may not be needed any more after the next one. Changes of the words, which cost the
// device, are tried first, then what costs time.
void take_back(const Plan& original, const Attempt& attempt, Search& search);
// Of plans with fewer passes, or fewer iterations a pass, down to `least_iterations`, the fastest
// that is cured too.
void save_time(int least_iterations, const Attempt& attempt, Search& search);

}  // namespace hvp::fixed
