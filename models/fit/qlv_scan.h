#pragma once

#include <vector>

#include "models/fit/problem.h"
#include "models/fit/qlv_log.h"

namespace hvp::fit {

// Where the attempts at a record begin. The stiffness jumps where the indenter touches, so that
// the sum of squares has a minimum of its own between any two samples of the first part of the
// ramp: contacts are tried there one after the other, the rest is fitted, and the best is where
// `parameters` then begin, with the contact drawn from around it. Where the best is the first place
// of all, the tissue was touched before the indenter moved: the contact is then free to lie further
// out, where it changes nothing, and so comes out as what the record does not give.
void begin_at_best_contact(const Problem& problem, const PressedLog& log,
                           std::vector<Parameter>& parameters);

}  // namespace hvp::fit
