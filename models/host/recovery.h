#pragma once

#include "models/config/declaration.h"

namespace hvp::host {

// When the driver goes to the trouble of a check.
enum class Guard { with_faults, always, never };

// What the host does about a board that fails. The scenario's table [host.recovery].
struct Recovery {
  Guard bus_errors = Guard::with_faults;
  Guard hold_saturated = Guard::with_faults;
  int retries = 1;
  int attempts = 8;
  int back_off_frames = 1;

  void declare(config::Visitor& v);

  // Frames that pass between a set-up that failed, the n-th in a row, and the next one.
  int back_off(int failed) const;
};

inline bool guards(Guard guard, bool faults) {
  return guard == Guard::always || (guard == Guard::with_faults && faults);
}

}  // namespace hvp::host
