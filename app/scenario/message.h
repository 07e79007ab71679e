#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "models/config/effects.h"
#include "models/files/one_line.h"

namespace hvp::scenario {

using files::in_quotes;
using files::one_line;
using files::printable;

// A key as TOML writes it: bare, or quoted where it must be.
std::string key_text(std::string_view key);

// `table` + "." + `key`, or `key` alone in the root.
std::string joined(std::string_view table, std::string_view key);

using config::alternatives;

}  // namespace hvp::scenario
