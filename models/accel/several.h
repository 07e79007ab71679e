#pragma once

#include "models/config/declaration.h"

namespace hvp::accel {

// Who works on the vectors of the solver.
enum class VectorWork {
  split,    // each device on the entries of its own rows
  unsplit,  // every device on all of them
};

// What of the multiplied vector the devices send each other, where vectors are split.
enum class Exchange {
  all,   // everything to everyone; rows are dealt as to partitions
  halo,  // what a device's rows touch; rows are partitioned by METIS
};

enum class Topology { ring, fully_connected };

// Several devices that share the rows of K: the scenario's effect [accelerator.several]. Links are
// full duplex; a device has one to either neighbour of its ring, or one to every other device.
struct Several {
  int devices = 2;
  VectorWork vectors = VectorWork::split;
  Exchange exchange = Exchange::all;
  Topology topology = Topology::ring;
  double link_latency_s = 80e-9;
  int link_width = 64;  // bits each way
  double link_clock_hz = 100e6;

  void declare(config::Visitor& v);
  void check() const;
};

}  // namespace hvp::accel
