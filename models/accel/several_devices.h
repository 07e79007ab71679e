#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"
#include "models/accel/links.h"

namespace hvp::accel {

// What one of several devices has.
struct DeviceShare {
  Pattern pattern;   // its rows, and how long its vectors are
  UnitClocks units;  // with the longest vectors that any device has
  int halo = 0;      // nodes of other devices whose words of d it gets
};

// Clocks of a solve with the links and without them.
struct SeveralCycles {
  SolveCycles solve;  // what the board takes: exchanges count to the phases that wait for them
  SolveCycles alone;  // if every link were free

  std::int64_t link_clocks_an_iteration() const { return solve.iteration() - alone.iteration(); }
  std::int64_t link_clocks() const { return solve.total() - alone.total(); }
};

// The rows of K dealt to several devices that solve together: docs/several-devices.md. All phases
// of an iteration begin together on every device, so that the slowest one counts. Words are those
// of one device: sums are exact, whatever their order.
class SeveralDevices {
 public:
  // Of `a.several`, which has to be there, with two devices or more. Throws InputError with the key
  // "several.devices" where there are fewer rows than devices.
  SeveralDevices(const Architecture& a, const Pattern& p);

  const std::vector<DeviceShare>& shares() const { return shares_; }
  int device_of(int row) const { return device_of_row_[static_cast<std::size_t>(row)]; }

  SeveralCycles solve(const SolveWork& work) const;
  // Words of the multiplied vector in one exchange, over all links' far ends.
  std::int64_t exchanged_words() const;

  // As accel::node_update_cycles: every device changes the rows that it has, all at once.
  std::int64_t node_update(const Pattern& p, int node, std::span<const int> neighbours,
                           fixed::Method method) const;
  std::int64_t load(const Pattern& p, fixed::Method method) const;

 private:
  int devices() const { return static_cast<int>(shares_.size()); }
  bool split() const { return several_.vectors == VectorWork::split; }
  Passes passes(const SolveWork& work) const;
  std::int64_t direction_exchange(const Passes& pass, const SolveWork& work) const;
  std::int64_t product_exchange(const Passes& pass, const SolveWork& work) const;

  Architecture architecture_;
  Several several_;
  Links links_;
  int nodes_;
  std::vector<int> device_of_row_;
  std::vector<DeviceShare> shares_;
  Demand demand_;
};

// A solve on so many devices.
struct Scaling {
  int devices = 1;
  std::int64_t clocks = 0;
  std::int64_t link_clocks = 0;
  double speed_up = 1;  // over one device
};
// From one device to `most` (64 at most, and no more than there are rows), all else as `a` says.
// With a.several absent, as Several's defaults say.
std::vector<Scaling> scaling(const Architecture& a, const Pattern& p, const SolveWork& work,
                             int most);

// What the speed-up tends to with free links and a device for every row: the pipelines, the
// divisions and, unsplit, the vector unit remain.
double speed_up_limit(const Architecture& a, const Pattern& p, const SolveWork& work);

}  // namespace hvp::accel
