#pragma once

#include <nlohmann/json_fwd.hpp>

#include "models/sparse/spectrum.h"

namespace hvp::results {

// Bounds of the extreme eigenvalues and of κ: {"smallest": [lower, upper], "largest": […],
// "condition": […]}. κ is null where the matrix is not proved positive definite.
nlohmann::ordered_json spectrum_json(const sparse::Spectrum& spectrum);

}  // namespace hvp::results
