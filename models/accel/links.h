#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "models/accel/several.h"

namespace hvp::accel {

// How many rows each device has to send to whom: for every source, rows by the set of devices that
// need them, a bit each.
using Demand = std::vector<std::map<std::uint64_t, int>>;

inline constexpr int kMostLinkedDevices = 64;

// The links between several devices, in clocks of the engine. A ring forwards words as they come:
// what is needed farthest goes first, each way round takes what is nearer that way, and what lies
// opposite goes half each way.
class Links {
 public:
  Links(const Several& several, double engine_clock_hz);

  double latency() const { return latency_; }
  // Until every row is where it is needed, when all sources begin at once with whole vectors.
  double exchange(const Demand& demand, int bits_a_row) const;
  // From the last words that a source sends to their arrival at the farthest device.
  double tail(int devices) const;
  // Until every device has a message of so many bits from each other one, and has put the words in
  // it together with its own: sums are exact, so that their order does not matter.
  std::int64_t reduction(int devices, int bits) const;

 private:
  double clocks(double bits) const { return bits / bits_a_clock_; }
  int hops(int devices) const;
  double one_way_round(const Demand& demand, int direction, int bits_a_row) const;

  Topology topology_;
  double latency_;
  double bits_a_clock_;
};

}  // namespace hvp::accel
