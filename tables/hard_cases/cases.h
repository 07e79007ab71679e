#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "models/fixed/remedy.h"
#include "models/stability/flag.h"
#include "tables/hard_cases/scene.h"

// The hard cases of the fixed-point solver: what tests/hard_cases/ asserts and what
// docs/hard-cases.md prints.
namespace hvp::tables {

// What a case is to come to.
enum class Ending {
  converges,  // as it is
  remedied,   // with what its flags name
  hopeless,   // in a flag, and no setting of the board helps
  refused,    // with a message, before anything is solved
};

struct Case {
  std::string name;
  std::string expected;  // a sentence without its full stop
  Ending ending = Ending::converges;
  // That the first attempt must raise; none where it converges or is refused.
  std::optional<stability::Flag> flag;
  fixed::Plan plan;
  std::function<std::unique_ptr<CaseScene>()> make;  // may throw InputError
};

struct Group {
  std::string title;
  std::vector<Case> cases;
};

std::vector<Group> hard_cases();

// The plan that every case starts with unless it says otherwise: Jacobi-PCG with 80 iterations
// from zero, 12-bit matrix and 16-bit vectors.
fixed::Plan first_plan();

// A case followed to its end: attempt, do what its flags name, attempt again.
struct Trail {
  std::string refusal;
  stability::Flags model;
  CaseOutcome first;
  std::vector<fixed::Remedy> remedies;
  // The last attempt. Where it converged, with as few iterations and passes as converge with its
  // words and scaling: a remedy once taken may not be needed any more after the next one.
  fixed::Plan plan;
  CaseOutcome last;
  bool converged = false;
  int attempts = 0;
  std::unique_ptr<CaseScene> scene;  // none where its model was refused
};

Trail follow(const Case& hard_case);

}  // namespace hvp::tables
