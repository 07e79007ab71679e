#pragma once

#include "models/config/declaration.h"

namespace hvp::vp {

// The effect [function]: what the configuration space of the board's PCI function has beyond the
// least, for hosts that see one.
struct PciFunction {
  bool pci_express = false;  // a capability of PCI Express, and 4 KiB of configuration space
  bool msi_x = false;        // messages by MSI-X, in the place of MSI
  int bar_bits = 32;         // of the address in the BAR of the registers, 32 or 64

  void declare(config::Visitor& v);
  // Throws InputError for another number of bits.
  void check() const;
};

}  // namespace hvp::vp
