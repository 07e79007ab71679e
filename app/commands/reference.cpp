#include "app/scenario/reference.h"

#include <fmt/format.h>

#include "app/commands/commands.h"

namespace hvp::app {

int reference_command() {
  fmt::print("{}", scenario::reference_page(Scenario{}));
  return kHeld;
}

}  // namespace hvp::app
