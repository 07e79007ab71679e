#include "vp/function/pci_function.h"

#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::vp {

void PciFunction::declare(config::Visitor& v) {
  v.boolean("pci_express", pci_express,
            {"a capability of PCI Express with the link of [bus.pcie], a reset of the function by "
             "it, and 4 KiB of configuration space",
             "the least that a board needs"});
  v.boolean("msi_x", msi_x,
            {"messages by MSI-X, with a table and pending bits in BAR 2, in the place of MSI; a "
             "message takes as long",
             "as above"});
  v.integer("bar_bits", bar_bits, {32, 64},
            {"of the address of the registers: 32, or 64 for a BAR of two words", "as above"});
}

void PciFunction::check() const {
  if (bar_bits == 32 || bar_bits == 64) return;
  throw InputError("bar_bits", fmt::format("expected 32 or 64, found {}", bar_bits));
}

}  // namespace hvp::vp
