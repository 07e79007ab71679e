#pragma once

#include <string>
#include <string_view>

#include "app/scenario/tree.h"

namespace hvp::scenario {

// A syntax error: the text is not TOML.
struct SyntaxError {
  int line = 1;
  int column = 1;
  std::string message;
};

// Parses a TOML document into a tree whose nodes carry the line of their key. Throws SyntaxError.
// Every level of nesting costs a stack frame, so tables or lists more than 32 deep and keys of more
// than 32 parts are refused before parsing.
Node parse_toml(std::string_view text);

// Parses the value of a --set override as TOML; a text that is not TOML is taken literally. Throws
// InputError if it starts like a TOML text, list or table but is malformed.
Node override_value(std::string_view text, int override_index);

}  // namespace hvp::scenario
