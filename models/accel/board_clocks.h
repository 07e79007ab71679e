#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"
#include "models/accel/several_devices.h"

namespace hvp::accel {

// What the board takes for a matrix, loosely timed: one device, or several where the architecture
// has them.
class BoardClocks {
 public:
  // Throws what SeveralDevices and packages_of() throw.
  BoardClocks(const Architecture& a, Pattern p);

  const Pattern& pattern() const { return pattern_; }
  const std::optional<SeveralDevices>& several() const { return several_; }

  SolveCycles solve(const SolveWork& work) const;
  // As the functions of cycles.h.
  std::int64_t node_update(int node, std::span<const int> neighbours, fixed::Method method) const;
  std::int64_t load(fixed::Method method) const;

 private:
  Architecture architecture_;
  Pattern pattern_;
  UnitClocks units_;
  std::optional<SeveralDevices> several_;
};

}  // namespace hvp::accel
