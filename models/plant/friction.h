#pragma once

#include "models/config/declaration.h"

namespace hvp::plant {

// The effect [device.friction]: dry friction (Coulomb's), each axis by itself. A device that slips
// is held back by `force_N`; one that stands is held until the other forces on it are larger than
// hold(). By itself along each axis is a simplification: a real drive's friction is its joints'.
struct Friction {
  double force_N = 0.26;
  double static_force_N = 0;  // 0: as large as force_N

  double hold() const { return static_force_N > 0 ? static_force_N : force_N; }

  void declare(config::Visitor& v);
  // Throws InputError: a device that stands is held by less than one that slips.
  void check() const;
};

}  // namespace hvp::plant
