#include <array>

#include "app/commands/commands.h"

namespace hvp::app {

// What needs neither fits nor outside hosts nor many runs: a third less to compile before the first
// answer. `first_commands` of the checkout's ./hvp are the same.
std::span<const AddCommand> commands() {
  static constexpr std::array<AddCommand, 6> kFirst = {add_run,  add_device, add_solve,
                                                       add_mesh, add_export, add_resolve};
  return kFirst;
}

}  // namespace hvp::app
