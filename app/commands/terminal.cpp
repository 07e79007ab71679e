#include "app/commands/terminal.h"

#include <cstdio>
#include <string>

#include "app/scenario/message.h"

namespace hvp::app {

void print_text(std::string_view text) {
  const std::string shown = scenario::printable(text);
  std::fwrite(shown.data(), 1, shown.size(), stdout);
}

void complain(std::string_view line) {
  constexpr std::size_t kLongest = 10'000;
  fmt::print(stderr, "{}\n", scenario::one_line(line, kLongest));
}

}  // namespace hvp::app
