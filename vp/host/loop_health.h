#pragma once

#include <array>
#include <cstdint>

#include "driver/hvp_driver.h"
#include "models/host/costs.h"
#include "models/stability/flag.h"
#include "vp/fault/fault_plan.h"
#include "vp/frame/servo_counts.h"
#include "vp/host/frame_solver.h"

namespace hvp::vp {

// The recovery of a solver that failed, in the time that the frames leave: one piece at a time,
// with growing delays between attempts, until it is given up.
class BoardRecovery {
 public:
  // Keeps references.
  BoardRecovery(const host::Recovery& policy, FrameSolver& solver)
      : policy_(policy), solver_(solver) {}

  // The solver can take a frame.
  bool ready() const { return ready_; }
  bool given_up() const { return given_up_at_ >= 0; }
  // The last error.
  hvp_status status() const { return status_; }

  // Frame `number` failed; the solver has to be set up.
  void begin(std::int64_t number, hvp_status status);
  // Makes the next piece if its time has come and it is likely to end by `until`; a frame's first
  // piece is always made, so that the recovery ends. Returns false if there is no work.
  bool work(std::int64_t number, Picoseconds until);

  std::int64_t recoveries() const { return recoveries_; }
  std::int64_t failed_attempts() const { return failed_attempts_; }
  std::int64_t given_up_at() const { return given_up_at_; }  // −1: never
  // The last attempt's error; HVP_OK if it succeeded.
  hvp_status last_failure() const { return failure_; }

 private:
  void fail(std::int64_t number, hvp_status status);

  const host::Recovery& policy_;
  FrameSolver& solver_;
  bool ready_ = true;
  hvp_status status_ = HVP_OK;
  hvp_status failure_ = HVP_OK;
  int failed_in_a_row_ = 0;
  std::int64_t next_attempt_ = 0;  // the first frame that may make one
  std::int64_t last_worked_ = -1;
  Picoseconds longest_piece_ = 0;
  std::int64_t recoveries_ = 0;
  std::int64_t failed_attempts_ = 0;
  std::int64_t given_up_at_ = -1;
};

// The flag of a frame that this error has left without a solution, or whose new matrix it lost.
// The status is none of success.
stability::Flag flag_of(hvp_status status);

// The servo loop's record of its solver's health: counts failures, reports noticed faults to the
// fault plan, and has the solver recovered.
class LoopHealth {
 public:
  // The outcome of a frame's solve.
  struct SolveEnd {
    std::int64_t frame;
    hvp_status status;
    bool attempted;  // false: the solver is being recovered, or was given up
  };

  // Keeps references.
  LoopHealth(const host::Recovery& policy, FrameSolver& solver)
      : policy_(policy), solver_(solver), recovery_(policy, solver) {}

  // Reports to the plan the faults that the driver notices.
  void report_to(FaultPlan& faults) { faults_ = &faults; }

  // Set-up failed for the `failed`-th time in a row. Throws std::runtime_error if it is not to be
  // repeated: a run without frames would count no miss and look successful.
  void set_up_failed(hvp_status status, int failed);
  // The first frame is born now.
  void loop_begins(Picoseconds now);
  // The last frame is over; `status` is the driver's on closing the board, `ticks` the number of
  // ticks.
  void closed(hvp_status status, std::int64_t ticks);

  // HVP_OK if the solver can take a frame, otherwise the error that prevents it.
  hvp_status solver_status() const { return recovery_.ready() ? HVP_OK : recovery_.status(); }
  // True after the solver was set up again without contact, until told_contact().
  bool lost_contact() const { return lost_contact_; }
  void told_contact() { lost_contact_ = false; }

  // Counts the outcome of a solve, attributes errors to faults and raises the flags of a failure.
  void solve_ended(const SolveEnd& end, std::uint32_t& flags);

  // The frame has its force, but what came after it failed: a solve with the contact's loads, or
  // the renewal of the matrix.
  void failed_after_force(hvp_status status, std::int64_t frame, std::uint32_t& flags);

  // True if the solver has failed and was not given up.
  bool recovers() const { return !recovery_.ready() && !recovery_.given_up(); }
  // Recovers the solver as far as the time until `until` allows.
  void recover(std::int64_t frame, Picoseconds until);

  ServoCounts& counts() { return counts_; }
  const ServoCounts& counts() const { return counts_; }

 private:
  void fail(const SolveEnd& end);
  void lose(hvp_status status, std::int64_t frame);
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
  std::int64_t last_solved_ = -1;  // the last frame with a solution
  ServoCounts counts_;
};

}  // namespace hvp::vp
