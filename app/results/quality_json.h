#pragma once

#include <nlohmann/json_fwd.hpp>

#include "app/results/outcome.h"

namespace hvp::results {

// summary.json's "accuracy": keys are null where nothing was compared.
nlohmann::ordered_json accuracy_json(const Outcome& outcome);

// "force": what the force is like; null where nobody computed one.
nlohmann::ordered_json force_json(const Outcome& outcome);

// "strain": how far the body was strained; null likewise.
nlohmann::ordered_json strain_json(const Outcome& outcome);

}  // namespace hvp::results
