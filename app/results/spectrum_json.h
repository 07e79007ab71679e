#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "models/fixed/spectrum.h"

namespace hvp::results {

// {"given": …, "scaled": …, "rounded": …}, each {"smallest": [lower, upper], "largest": […],
// "condition": […]}: bounds of the extreme eigenvalues and of κ, which is null where the matrix is
// not proved positive definite. Null where the spectrum was not asked for.
nlohmann::ordered_json condition_json(const std::optional<fixed::SystemSpectrum>& spectrum);

}  // namespace hvp::results
