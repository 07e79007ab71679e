#pragma once

#include <optional>
#include <string>
#include <vector>

#include "models/link/pcie.h"

namespace hvp::fit {

// How long a board's transfers of each size took, without what disturbed some of them: sizes
// ascend, and each is there once.
struct TimesOfSizes {
  std::vector<double> bytes;
  std::vector<double> seconds;

  bool empty() const { return bytes.empty(); }
};

// The medians of the transfers of each size.
TimesOfSizes medians_of_sizes(const std::vector<double>& bytes, const std::vector<double>& seconds);

// The settings of [bus.pcie] that come nearest to a measurement.
struct NearestPcie {
  link::Pcie pcie;
  // Half of the sizes are at most this share off; absent where nothing was measured.
  std::optional<double> read_deviation;
  std::optional<double> write_deviation;
  std::vector<std::string> warnings;
};

// Finds generation, lanes, payload of a packet, reads in flight and latencies of a PCI Express link
// whose board reads and writes the host's memory. All combinations are tried, by
// link::Pcie::read_ps() and posted_write_ps() of whole bytes: the latency of the link is that which
// leaves the writes neither long nor short, that of the root complex likewise of the reads, and
// where there are no writes the link keeps its own. A combination's error is the mean of
// |log(model / measured)| over the sizes, the worse direction's. Of those within half a percent of
// the best, the one is taken that changes the fewest of `base`'s keys; a warning names other links
// that are as near, since a rate alone does not tell lanes from generations. What was not measured
// stays as in `base`. Needs a direction with two sizes.
NearestPcie nearest_pcie(const link::Pcie& base, const TimesOfSizes& read,
                         const TimesOfSizes& write);

}  // namespace hvp::fit
