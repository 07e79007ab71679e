#pragma once

#include <string>
#include <vector>

#include "models/fit/tissue_problem.h"

namespace hvp::fit {

// The log as the model takes it, and a warning for each thing that was repaired or is doubtful.
// `name` stands before every sentence ("log 2"). Throws InputError; see TissueProblem.
TissueLog checked_log(const TissueBody& body, TissueLog log, const std::string& name,
                      std::vector<std::string>& warnings);

}  // namespace hvp::fit
