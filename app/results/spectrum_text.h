#pragma once

#include <string>

#include "models/fixed/spectrum.h"

namespace hvp::results {

// A line for each matrix whose spectrum was bounded: κ and both ends.
std::string spectrum_text(const fixed::SystemSpectrum& spectrum);

}  // namespace hvp::results
