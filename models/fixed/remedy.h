#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/fixed/settings.h"
#include "models/stability/flag.h"

namespace hvp::fixed {

// The part of a system's solution that a remedy may change.
struct Plan {
  Settings settings;
  // The solves of a frame; between them the host forms b - A·x in double precision and the board
  // solves for the increment. 1: no refinement.
  int passes = 1;
  // Where the matrix is renewed: after so many frames, and the room of the words over its largest
  // entry at rest. 0: it is not.
  int renew_every = 0;
  double headroom = 0;

  friend bool operator==(const Plan&, const Plan&) = default;
};

// What the host knows of the frames: the largest displacement, for displacement_range; the passes
// for which there is time; whether there is a matrix that could be renewed, of a body that is not
// linear and is solved by increments; and what the renewed one has grown to.
struct Extent {
  double largest_displacement = 0;  // m; 0: unknown
  int most_passes = 6;
  bool renewable = false;
  double growth = 0;  // its largest entry over that at rest; 0: unknown
};

// One change of a plan.
struct Remedy {
  stability::Flag flag = stability::Flag::count;  // the flag that it treats
  Plan plan;
  std::string change;  // "solver.matrix_bits = 16, solver.vector_bits = 20"
};

// The remedy for the flags that a solve with that plan has raised. Of several flags the cause is
// treated before its consequences. Each flag's remedies are tried in the order in which its text
// names them (stability::describe): first those that cost no time in a frame, then those that cost
// time, then wider words, which cost the device. Returns the first change that is not yet in force;
// none if all are, or if no setting of the board helps. Following it repeatedly ends after a few
// dozen steps.
std::optional<Remedy> next_remedy(stability::Flags flags, const Plan& plan,
                                  const Extent& extent = {});

// The changes from one plan to another as lines of a scenario: "solver.iterations = 160".
std::vector<std::string> changes(const Plan& from, const Plan& to);
// The same in one line: "solver.iterations = 160, refinement.passes = 2".
std::string difference(const Plan& from, const Plan& to);

// The outcome of an attempt with a plan.
struct Trial {
  bool refused = false;  // no such system exists, or it cannot be solved
  stability::Flags flags;
  bool cured() const { return !refused && flags.empty(); }
};
using Attempt = std::function<Trial(const Plan&)>;

// The result of following remedies until no flag is left.
struct Search {
  Plan plan;  // the last one tried
  Trial last;
  std::vector<Remedy> remedies;
  int attempts = 0;
};

// Follows next_remedy() from `first`, the outcome of `plan`, attempt by attempt until one is cured,
// with at most `most` attempts.
Search follow_remedies(const Plan& plan, const Trial& first, const Extent& extent,
                       const Attempt& attempt, int most);
// Takes back, one after the other, the changes without which a cured search stays cured: a later
// remedy may make an earlier one unnecessary. Changes of the words, which cost the device, are
// tried first, then those that cost time.
void take_back(const Plan& original, const Attempt& attempt, Search& search);
// Replaces the plan by the fastest one that is cured too, among plans with fewer passes, or with
// fewer iterations a pass, down to `least_iterations`.
void save_time(int least_iterations, const Attempt& attempt, Search& search);

}  // namespace hvp::fixed
