#pragma once

#include <array>
#include <cstdint>

#include "driver/hvp_driver.h"
#include "models/host/recovery.h"
#include "vp/fault/fault_plan.h"
#include "vp/host/board_recovery.h"
#include "vp/host/frame_solver.h"

namespace hvp::vp {

struct ErrorCount {
  std::int64_t count = 0;
  std::int64_t first_frame = -1;  // −1: before the first frame
};

// What went wrong in the servo loop that is not in the ledger.
struct ServoCounts {
  std::int64_t saturations = 0;  // in the board's solves
  std::int64_t breakdowns = 0;
  std::int64_t clamped_words = 0;   // of right-hand sides that did not fit
  std::int64_t clamped_forces = 0;  // frames whose force did not fit the device's register
  std::int64_t driver_errors = 0;   // frames whose solve failed; the last force was held
  std::int64_t held_frames = 0;     // those, and frames without a board meanwhile
  std::int64_t longest_hold = 0;    // ticks in a row without a new force, skipped ones included
  // What the driver returned, by status: frames, accesses that were repeated, failed set-ups.
  std::array<ErrorCount, HVP_STATUS_COUNT> errors{};
  Mended mended;                // what cost time only
  std::int64_t recoveries = 0;  // the board was set up again
  std::int64_t failed_set_ups = 0;
  std::int64_t given_up_at = -1;  // the frame in which the board was; −1: was not
  std::int64_t contact_changes = 0;
  std::uint32_t flags = 0;  // stability::Flags of all solves
  hvp_status last_error = HVP_OK;
};

// Whether the servo loop can rely on its solver: counts what failed, tells the faults' plan what
// was noticed, and has the solver brought back.
class LoopHealth {
 public:
  // How a frame's solve ended.
  struct SolveEnd {
    std::int64_t frame;
    hvp_status status;
    bool attempted;  // false: the solver is being brought back, or was given up
  };

  // Keeps references.
  LoopHealth(const host::Recovery& policy, FrameSolver& solver)
      : policy_(policy), solver_(solver), recovery_(policy, solver) {}

  // Tells the plan what the driver has noticed.
  void report_to(FaultPlan& faults) { faults_ = &faults; }

  // Set-up failed for the `failed`-th time in a row. Throws std::runtime_error where it is not to
  // be tried again: without a frame no miss would be counted, and the run would look like one that
  // held.
  void set_up_failed(hvp_status status, int failed);
  // The first frame is born now.
  void loop_begins(Picoseconds now);
  // After the last frame: how the board was left, and how many ticks there were.
  void closed(hvp_status status, std::int64_t ticks);

  // The solver can take a frame, or why it cannot.
  hvp_status solver_status() const { return recovery_.ready() ? HVP_OK : recovery_.status(); }
  // The solver was set up again and knows of no contact; until told_contact().
  bool lost_contact() const { return lost_contact_; }
  void told_contact() { lost_contact_ = false; }

  // Counts, and attributes to faults, what the solve's end says; raises the flags of what failed.
  void solve_ended(const SolveEnd& end, std::uint32_t& flags);

  // There is something to bring back.
  bool recovers() const { return !recovery_.ready() && !recovery_.given_up(); }
  // As far as the time until then allows.
  void recover(std::int64_t frame, Picoseconds until);

  ServoCounts& counts() { return counts_; }
  const ServoCounts& counts() const { return counts_; }

 private:
  void fail(const SolveEnd& end);
  void count_mended(std::int64_t frame);
  void count_ticks_without_force(std::int64_t until);
  void note(hvp_status status, std::int64_t frame);
  void count(hvp_status status, std::int64_t frame, std::int64_t times);
  void notice(FaultKind kind, std::int64_t frame) {
    if (faults_ != nullptr) faults_->notice(kind, frame);
  }
  void notice_failure(std::int64_t frame) {
    if (faults_ != nullptr) faults_->notice_failure(frame);
  }

  const host::Recovery& policy_;
  FrameSolver& solver_;
  BoardRecovery recovery_;
  FaultPlan* faults_ = nullptr;
  bool lost_contact_ = false;
  std::int64_t last_solved_ = -1;  // frame
  ServoCounts counts_;
};

}  // namespace hvp::vp
