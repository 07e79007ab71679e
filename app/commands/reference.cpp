#include "app/scenario/reference.h"

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/commands/terminal.h"
#include "app/results/reference_json.h"
#include "app/results/results_reference.h"

namespace hvp::app {

int reference_command(const ReferenceArguments& arguments) {
  if (arguments.json) {
    print("{}", results::reference_json(HVP_VERSION));
    return kHeld;
  }
  print("{}", arguments.results ? results::results_reference_page()
                                : scenario::reference_page(Scenario{}));
  return kHeld;
}

}  // namespace hvp::app
