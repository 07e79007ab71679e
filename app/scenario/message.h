#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "models/config/effects.h"
#include "models/files/one_line.h"

namespace hvp::scenario {

using files::in_quotes;
using files::one_line;
using files::printable;

// Writes a key as TOML does: bare, or in quotes if it needs them.
std::string key_text(std::string_view key);

// Returns `table` + "." + `key`, or `key` alone in the root.
std::string joined(std::string_view table, std::string_view key);

using config::alternatives;

// The restricted Damerau-Levenshtein distance: the number of insertions, deletions, substitutions
// and swaps of neighbours that turn one name into the other. Letter case is ignored, and '-' equals
// '_'.
std::size_t edit_distance(std::string_view a, std::string_view b);

// Guesses which candidate `name` was meant to be: the one with the smallest edit distance, the
// first if several are equal, provided the distance is at most a third of the shorter name's length
// (at least one); otherwise the only candidate that starts with `name`. Returns an empty text if
// there is none.
std::string_view nearest(std::string_view name, const std::vector<std::string_view>& candidates);

}  // namespace hvp::scenario
