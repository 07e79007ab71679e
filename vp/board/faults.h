#pragma once

#include <vector>

#include "vp/board/faulty_wire.h"
#include "vp/board/lossy_line.h"
#include "vp/fault/bus_errors.h"
#include "vp/fault/fault_plan.h"

namespace hvp::vp {

// What a scenario with [[fault]] has between the bus, the board and the host; it is not there in
// any other.
struct Faults {
  Faults(const std::vector<Fault>& faults, std::int64_t seed, Picoseconds period, BusErrors& errors,
         const link::Pcie* link, InterruptIf& host)
      : plan(faults, seed, period),
        wire("faulty_wire", plan, errors, link),
        line("lossy_line", plan, host) {}

  FaultPlan plan;
  FaultyWire wire;
  LossyLine line;
};

}  // namespace hvp::vp
