#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "models/config/effects.h"

namespace hvp::scenario {

// The text with every character escaped that a terminal would obey instead of showing it: control
// characters (\n, \t, \u0007, \u009b), what turns the direction of writing (\u202e), and bytes that
// are no UTF-8 (\x9b). Cut after `limit` bytes at a character's border, so that what came from a
// file cannot break an error's one line.
std::string one_line(std::string_view text, std::size_t limit = 200);

// The same without a limit, for a report of several lines: line ends stay.
std::string printable(std::string_view text);

// The same in double quotes, for "found …".
std::string in_quotes(std::string_view text, std::size_t limit = 60);

// A key as TOML writes it: bare, or quoted where it must be.
std::string key_text(std::string_view key);

// `table` + "." + `key`, or `key` alone in the root.
std::string joined(std::string_view table, std::string_view key);

using config::alternatives;

}  // namespace hvp::scenario
