#pragma once

#include <cstddef>
#include <string>
#include <string_view>

// The text of a user's file in a message. Its bytes need not be text.
namespace hvp::files {

// The text with every character escaped that a terminal would obey instead of showing it: control
// characters (\n, \t, \u0007, \u009b), what turns the direction of writing (\u202e), and bytes that
// are no UTF-8 (\x9b). Cut after `limit` bytes at a character's border, so that what came from a
// file cannot break an error's one line.
std::string one_line(std::string_view text, std::size_t limit = 200);

// The same without a limit, for a report of several lines: line ends stay.
std::string printable(std::string_view text);

// The same in double quotes, for "found …".
std::string in_quotes(std::string_view text, std::size_t limit = 60);

}  // namespace hvp::files
