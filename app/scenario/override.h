#pragma once

#include <string>
#include <string_view>

#include "app/scenario/tree.h"

namespace hvp::scenario {

// The value of a --set override: TOML where it is, else text as it stands. Throws InputError
// where it starts like a TOML text, list or table and is none.
Node override_value(std::string_view text, int override_index);

// Puts `value` at `key` of the tree. Throws InputError: not a key, a step into something that
// is no table or list, an index beyond the list.
void put(Node& root, const std::string& key, Node value);

}  // namespace hvp::scenario
