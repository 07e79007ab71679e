#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace hvp::scenario {

// Insertions, deletions, substitutions and swaps of neighbours that turn one name into the
// other (the restricted Damerau-Levenshtein distance). Letter case does not count, and '-' is
// the same as '_'.
std::size_t edit_distance(std::string_view a, std::string_view b);

// The candidate that `name` was probably meant to be: the one with the smallest edit distance,
// up to a third of the shorter name's length (at least one), the first of equals; else the
// only one that starts with `name`. Empty where there is none.
std::string_view nearest(std::string_view name, const std::vector<std::string_view>& candidates);

}  // namespace hvp::scenario
