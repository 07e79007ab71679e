#pragma once

#include <optional>
#include <string>
#include <vector>

#include "models/link/pci.h"

namespace hvp::fit {

// What a fit says of one direction.
struct Link {
  double latency_s = 0;
  double bandwidth = 0;  // bytes/s
};

// The settings of [bus] that come nearest to a measurement.
struct NearestPci {
  link::Pci pci;
  // The setting's bandwidth over the measured one, less one.
  std::optional<double> read_deviation;
  std::optional<double> write_deviation;
  std::vector<std::string> warnings;
};

// Bytes/s of transfers of whole bursts, without the latency.
double read_bandwidth(const link::Pci& pci);
double write_bandwidth(const link::Pci& pci);

// The latencies are the measured ones: a straight line through transfers of whole bursts meets the
// axis there. Bandwidth has steps: kind, length of bursts, clocks of overhead and of waiting are
// tried in all combinations, and of those within half a percent of the best one is taken that
// changes the fewest of `base`'s keys, by the least. What was not measured stays `base`'s.
NearestPci nearest_pci(const link::Pci& base, const std::optional<Link>& read,
                       const std::optional<Link>& write);

}  // namespace hvp::fit
