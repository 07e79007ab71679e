#pragma once

#include <cstdint>
#include <span>

#include "driver/hvp_driver.h"
#include "models/host/costs.h"
#include "vp/frame/frame_tag.h"
#include "vp/frame/ledger.h"
#include "vp/host/job_observer.h"
#include "vp/host/local_time.h"

namespace hvp::vp {

// Time that the servo process spends at work: spans of the host that follow the tag.
class Work {
 public:
  Work(const host::Host& costs, bool untimed, Tag& tag, LocalTime& time, Ledger& ledger)
      : costs_(costs), untimed_(untimed), tag_(tag), time_(time), ledger_(ledger) {}

  void spend(Phase phase, double seconds, double operations = 0) const {
    if (untimed_) return;
    const Picoseconds start = time_.now();
    time_.advance(to_picoseconds(seconds) + costs_.compute_ps(operations));
    // Behind what is still under way the order of the spans would be another.
    if (ledger_.holds()) time_.synchronise();
    ledger_.extend(tag_, Part::host, phase, start, time_.now());
  }
  Picoseconds now() const { return time_.now(); }
  const host::Host& costs() const { return costs_; }
  Tag& tag() const { return tag_; }

 private:
  host::Host costs_;
  bool untimed_;
  Tag& tag_;
  LocalTime& time_;
  Ledger& ledger_;
};

// What cost time only.
struct Mended {
  int lost_interrupts = 0;
  int lost_acknowledgements = 0;
  // The frames that made them, −1: none: the one that is worked on, an earlier one.
  std::int64_t unacknowledged_here = -1;
  std::int64_t unacknowledged_before = -1;
  int aborted = 0;  // accesses that were repeated
  int damaged = 0;
};

// Who finds a frame's displacements: the board, behind its driver, or the host itself. All calls
// are made in the servo thread and take simulated time.
class FrameSolver {
 public:
  virtual ~FrameSolver() = default;

  // Before the first frame, and again after a frame that failed: the solver has the matrix without
  // contact. A piece at a time, until `done`; after an error the next piece is the first one again.
  virtual hvp_status set_up_piece(bool& done) = 0;
  // The frame failed with this. False where the solver has to be set up again.
  virtual bool survives(hvp_status /*status*/) const { return true; }
  // Until when the frame's force is due: what failed is not tried again later than that.
  virtual void set_deadline(Picoseconds /*time*/) {}
  // The nodes (active, ascending) that follow the probe from now on.
  virtual hvp_status move_contact(std::span<const int> nodes) = 0;
  // Everything up to the point where the solver works and the host need not wait for it.
  virtual hvp_status begin(std::uint32_t& flags) = 0;
  // Waits for what begin() began and takes the solution.
  virtual hvp_status end(std::uint32_t& flags) = 0;
  // What is left to do once the force is out.
  virtual void finish(std::uint32_t& flags) = 0;
  virtual hvp_status close() = 0;

  // Who is told of the board's jobs; a solver without a board has none.
  virtual void observe(JobObserver& /*observer*/) {}

  // What went wrong since the last call and was put right.
  virtual Mended take_mended() { return {}; }

  // Words of right-hand sides that did not fit, since the last call.
  virtual std::int64_t take_clamped_words() { return 0; }
};

}  // namespace hvp::vp
