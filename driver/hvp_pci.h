// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#ifndef HVP_PCI_H
#define HVP_PCI_H

// The board's identity in its PCI configuration space (PCI 3.0 §6.2.1), for the model that shows it
// and for the operating system's driver that searches for it.

// The board's FPGA is Altera's, and Altera lends its vendor number to designs on its parts; there
// is no number of this board's own.
#define HVP_PCI_VENDOR_ID 0x1172
// "HP".
#define HVP_PCI_DEVICE_ID 0x4850
// A processing accelerator (PCI Code and ID Assignment 1.9 §1.19: base class 12h).
#define HVP_PCI_CLASS 0x120000
// Registers and memories of docs/registers.md: memory, 32 bits, not prefetchable.
#define HVP_PCI_BAR 0

#endif
