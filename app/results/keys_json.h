#pragma once

#include <nlohmann/json.hpp>

#include "app/scenario/outline.h"

// A declaration as JSON: what a scenario may have. docs/json.md describes the format.

namespace hvp::results {

// Every key, in the order of declaration.
nlohmann::ordered_json keys_json(const scenario::Outline& outline);

// Every effect, in the order of declaration.
nlohmann::ordered_json effects_json(const scenario::Outline& outline);

}  // namespace hvp::results
