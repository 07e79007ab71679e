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
// each read request of the device. Published times are those of whole reads of 64 bytes over Gen3
// x8, as a device sees them; Pcie's time of such a read without the root complex is subtracted.
struct RootComplexLatencies : random::TimeDistribution {
  enum PublishedHost { xeon_e5, xeon_e3 };

  RootComplexLatencies();
  void declare(config::Visitor& v);
  // The distribution with the points of the chosen host.
  random::TimeDistribution drawn() const;
};

// The published times of whole reads, s. docs/pcie.md says which points are published and which are
// assumed.
const std::vector<random::Exceedance>& published_reads(RootComplexLatencies::PublishedHost host);

// The time of such a read outside of the root complex, s.
double published_reads_beside_root_complex_s();

}  // namespace hvp::link
