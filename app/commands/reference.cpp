#include "app/scenario/reference.h"

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/commands/terminal.h"

namespace hvp::app {

int reference_command() {
  print("{}", scenario::reference_page(Scenario{}));
  return kHeld;
}

}  // namespace hvp::app
