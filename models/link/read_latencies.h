#pragma once

#include "models/config/declaration.h"
#include "models/random/distribution.h"

namespace hvp::link {

// The scenario's effect [bus.read_latencies]: Pci::read_latency_s drawn for each of the processor's
// reads.
struct PciReadLatencies : random::TimeDistribution {
  PciReadLatencies();
  void declare(config::Visitor& v);
};

// The scenario's effect [bus.pcie.root_complex_latencies]: Pcie::root_complex_latency_s drawn for
// each read request of the device. Published times are of whole reads of 64 bytes over Gen3 x8, as
// a device sees them: what Pcie counts for such a read without the root complex is subtracted.
struct RootComplexLatencies : random::TimeDistribution {
  enum PublishedHost { xeon_e5, xeon_e3 };

  RootComplexLatencies();
  void declare(config::Visitor& v);
  // With the points of the host that is chosen.
  random::TimeDistribution drawn() const;
};

// Whole reads, s. docs/pcie.md says which points are published and which are assumed.
const std::vector<random::Exceedance>& published_reads(RootComplexLatencies::PublishedHost host);

// s: of such a read, all that is not the root complex'.
double published_reads_beside_root_complex_s();

}  // namespace hvp::link
