#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/config/figures.h"
#include "vp/fault/fault_plan.h"
#include "vp/frame/servo_counts.h"

// Injected faults and the driver's errors: figures, and their text for the terminal.

namespace hvp::results {

struct Outcome;

// The table `driver`: the statuses that the driver returned and how the servo loop reacted.
void report_driver(config::Figures& f, const vp::ServoCounts& counts);

// The list `faults`: one entry for each item of [[fault]], of a run with so many frames.
// `driver_is_known` is false where the driver belongs to another program, so that its notices are
// not known.
void report_faults(config::Figures& f, const std::vector<vp::FaultRecord>& faults,
                   std::int64_t frames, bool driver_is_known = true);

// The table `flips`: what all faults of kind flip have done.
struct Flips {
  Flips() = default;
  explicit Flips(const std::vector<vp::FaultRecord>& faults);
  void report(config::Figures& f) const;

  std::int64_t made = 0, noticed = 0, wrong = 0, told = 0;
  std::int64_t last_wrong_frame = -1;
  double worst = 0;
  std::string first;
};

// None without such a fault.
std::optional<Flips> flips_of(const std::vector<vp::FaultRecord>& faults);

// The terminal's section on injected faults and the driver's errors; empty without either.
std::string fault_text(const Outcome& outcome);

}  // namespace hvp::results
