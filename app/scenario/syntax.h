#pragma once

#include <string>
#include <string_view>

#include "app/scenario/tree.h"

namespace hvp::scenario {

// A text that is not TOML.
struct SyntaxError {
  int line = 1;
  int column = 1;
  std::string message;
};

// Parses a TOML document into a tree whose nodes carry the line of their key. Throws
// SyntaxError. Text that nests tables or lists more than 32 deep, or that has a key of more
// than 32 parts, is refused before it is parsed: every level costs a stack frame later.
Node parse_toml(std::string_view text);

}  // namespace hvp::scenario
