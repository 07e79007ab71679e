#pragma once

#include <string_view>
#include <utility>

#include <fmt/format.h>

// What the commands say. Titles and names of files are a user's words and may hold anything:
// characters that a terminal would obey are escaped here, for all of them.
namespace hvp::app {

void print_text(std::string_view text);

// To standard output.
template <class... Arguments>
void print(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  print_text(fmt::format(format, std::forward<Arguments>(arguments)...));
}

// One line to standard error.
void complain(std::string_view line);

}  // namespace hvp::app
