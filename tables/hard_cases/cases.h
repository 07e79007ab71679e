#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "models/fixed/remedy.h"
#include "models/stability/flag.h"
#include "tables/hard_cases/scene.h"

// The hard cases of the fixed-point solver, which tests/hard_cases/ asserts and docs/hard-cases.md
// prints.
namespace hvp::tables {

// The expected result of a case.
enum class Ending {
  converges,  // at the first attempt
  remedied,   // after the remedies that its flags name
  hopeless,   // raises a flag, and no setting of the board helps
  refused,    // with an error message before the solve
};

struct Case {
  std::string name;
  std::string expected;  // a sentence without its full stop
  Ending ending = Ending::converges;
  // The flag that the first attempt must raise; none if it converges or is refused.
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

// The history of a case: it is attempted, and after each failure attempted again with the remedy
// that its flags name.
struct Trail {
  std::string refusal;
  stability::Flags model;
  CaseOutcome first;
  std::vector<fixed::Remedy> remedies;
  // The plan of the last attempt. If that converged, the plan has the least iterations and passes
  // with which its words and scaling converge, as a later remedy can make an earlier one
  // unnecessary.
  fixed::Plan plan;
  CaseOutcome last;
  bool converged = false;
  int attempts = 0;
  std::unique_ptr<CaseScene> scene;  // none if the model was refused
};

Trail follow(const Case& hard_case);

}  // namespace hvp::tables
