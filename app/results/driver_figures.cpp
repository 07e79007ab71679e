#include "app/results/driver_figures.h"

#include <cstddef>

namespace hvp::results {

namespace {

struct StatusErrors {
  std::string_view status;
  vp::ErrorCount errors;

  void report(config::Figures& f) const {
    f.count("count", errors.count,
            "how often the driver returned it: frames, accesses that were repeated, set-ups that "
            "failed");
    f.count("first_frame", errors.first_frame, "-1 in set-up");
  }
};

std::vector<StatusErrors> errors_of(const vp::ServoCounts& counts) {
  std::vector<StatusErrors> errors;
  for (std::size_t i = 0; i < counts.errors.size(); ++i) {
    if (counts.errors[i].count == 0) continue;
    errors.push_back({hvp_status_name(static_cast<hvp_status>(i)), counts.errors[i]});
  }
  return errors;
}

}  // namespace

void report_driver(config::Figures& f, const vp::ServoCounts& c) {
  f.tables("errors", "by status; those that never came are left out", errors_of(c),
           [](const StatusErrors& e) { return e.status; });
  f.count("repeated_accesses", c.mended.aborted + c.mended.damaged, "what cost time only");
  f.count("lost_interrupts", c.mended.lost_interrupts, "likewise");
  f.count("lost_acknowledgements", c.mended.lost_acknowledgements, "likewise");
  f.count("held_frames", c.held_frames, "frames whose force is that of an earlier one");
  f.count("longest_hold_ticks", c.longest_hold,
          "ticks in a row without a new force, skipped ones included");
  f.count("recoveries", c.recoveries, "how often the board was set up again");
  f.count("failed_set_ups", c.failed_set_ups, "and in vain");
  f.frame("given_up_frame", c.given_up_at, "where the board was given up, or null");
}

void report_faults(config::Figures& f, const std::vector<vp::FaultRecord>& faults,
                   bool driver_is_known) {
  f.list("faults", "One entry for each `[[fault]]` ([faults.md](faults.md)).", faults,
         [&](const vp::FaultRecord& r) {
           f.text("kind", vp::name(r.fault.kind), "what it is");
           f.count("injected", r.injected, "how often");
           f.when(driver_is_known, [&] { f.count("noticed", r.noticed, "by the driver"); });
           f.count("corrected", r.corrected, "by the bus, at the cost of time");
           f.when(driver_is_known, [&] { f.count("unnoticed", r.unnoticed(), "by nobody"); });
           f.count("first_frame", r.injected > 0 ? std::optional(r.first_frame) : std::nullopt,
                   "in which it was injected, or null");
         });
}

}  // namespace hvp::results
