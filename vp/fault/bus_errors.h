#pragma once

namespace hvp::vp {

// What the bridge's status register keeps until somebody clears it (PCI 3.0 §6.2.3): received
// master abort (bit 13), and master data parity error (bit 8), which its own check of a read or the
// target's PERR# after a write sets.
struct BusErrors {
  bool master_abort = false;
  bool parity = false;
};

}  // namespace hvp::vp
