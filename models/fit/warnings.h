#pragma once

#include <string>
#include <vector>

#include "models/fit/fit.h"

namespace hvp::fit {

// What a user has to know before trusting the values: a line each, the gravest first.
std::vector<std::string> warnings_of(const Fit& fit, const Problem& problem,
                                     const Options& options);

}  // namespace hvp::fit
