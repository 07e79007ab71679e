#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "models/stability/flag.h"

namespace hvp::results {

// The names of the flags that are up, in their order.
std::vector<std::string> flag_names(stability::Flags flags);

// The other way round; names that are none are left out.
stability::Flags flags_named(const std::vector<std::string>& names);

// A list of {"flag", "meaning", "remedy"}, one for each flag that is up.
nlohmann::ordered_json remedies_json(stability::Flags flags);

}  // namespace hvp::results
