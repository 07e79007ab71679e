#include <array>

#include "app/commands/commands.h"

namespace hvp::app {

std::span<const AddCommand> commands() {
  static constexpr std::array<AddCommand, 16> kAll = {
      add_run,    add_explain, add_misses,  add_device,   add_stability, add_serve,
      add_linux,  add_replay,  add_fit,     add_measure,  add_solve,     add_mesh,
      add_export, add_rtl,     add_resolve, add_reference};
  return kAll;
}

}  // namespace hvp::app
