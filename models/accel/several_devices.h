#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"

namespace hvp::accel {

// The rows that each device has to send: for every source, a number of rows by the set of devices
// that need them, one bit a device.
using Demand = std::vector<std::map<std::uint64_t, int>>;

inline constexpr int kMostLinkedDevices = 64;

// The links between several devices, in clocks of the engine. A ring forwards words as they come.
// Words for the farthest device go first; each word takes the shorter way round, and of those for
// the opposite device half go each way.
class Links {
 public:
  Links(const Several& several, double engine_clock_hz);

  double latency() const { return latency_; }
  // The clocks until every row has arrived where it is needed, if all sources begin at once with
  // whole vectors.
  double exchange(const Demand& demand, int bits_a_row) const;
  // The clocks from the last words that a source sends to their arrival at the farthest device.
  double tail(int devices) const;
  // The clocks until every device has a message of `bits` bits from each other one and has added
  // its words to its own. Sums are exact, so that their order does not matter.
  std::int64_t reduction(int devices, int bits) const;

 private:
  double clocks(double bits) const { return bits / bits_a_clock_; }
  int hops(int devices) const;
  double one_way_round(const Demand& demand, int direction, int bits_a_row) const;

  Topology topology_;
  double latency_;
  double bits_a_clock_;
};

// The share of one of several devices.
struct DeviceShare {
  Pattern pattern;   // its rows, and how long its vectors are
  UnitClocks units;  // with the longest vectors that any device has
  int halo = 0;      // nodes of other devices whose words of d it receives
};

// The clocks of a solve with the links and without them.
struct SeveralCycles {
  SolveCycles solve;  // the board's clocks: exchanges count to the engine phases that wait for them
  SolveCycles alone;  // the clocks if the links took no time

  std::int64_t link_clocks_an_iteration() const { return solve.iteration() - alone.iteration(); }
  std::int64_t link_clocks() const { return solve.total() - alone.total(); }
};

// Several devices that solve together, each with a share of K's rows: docs/several-devices.md.
// Every engine phase of an iteration begins on all devices at once, so that the slowest one counts.
// The words are those of one device, because sums are exact in any order.
class SeveralDevices {
 public:
  // `a.several` has to be there, with two devices or more. Throws InputError with the key
  // "several.devices" if there are fewer rows than devices.
  SeveralDevices(const Architecture& a, const Pattern& p);

  const std::vector<DeviceShare>& shares() const { return shares_; }
  int device_of(int row) const { return device_of_row_[static_cast<std::size_t>(row)]; }

  SeveralCycles solve(const SolveWork& work) const;
  // The words of the multiplied vector that all devices receive in one exchange.
  std::int64_t exchanged_words() const;

  // The counterpart of accel::node_update_cycles(): all devices change their rows at once.
  std::int64_t node_update(const Pattern& p, int node, std::span<const int> neighbours,
                           const fixed::Settings& settings) const;
  std::int64_t load(const Pattern& p, const fixed::Settings& settings) const;

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

// The clocks of a solve on a number of devices.
struct Scaling {
  int devices = 1;
  std::int64_t clocks = 0;
  std::int64_t link_clocks = 0;
  double speed_up = 1;  // over one device
};
// The clocks of the solve on one device, two, … up to `most` (64 at most, and no more than there
// are rows), all else as `a` says. If a.several is absent, Several's defaults apply.
std::vector<Scaling> scaling(const Architecture& a, const Pattern& p, const SolveWork& work,
                             int most);

// The speed-up in the limit of links that take no time and a device for every row: the pipelines,
// the divisions and, if vectors are unsplit, the vector unit remain.
double speed_up_limit(const Architecture& a, const Pattern& p, const SolveWork& work);

}  // namespace hvp::accel
