#pragma once

#include <array>
#include <cstdint>

#include "driver/hvp_driver.h"
#include "models/host/recovery.h"
#include "vp/host/frame_solver.h"

namespace hvp::vp {

// Brings a solver back that failed, in the time that the frames leave: a piece at a time, with a
// back-off between attempts that grows, until it is given up.
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
  // The next piece, if it is time for one and it will be over by `until` as far as one can tell;
  // the first of a frame is always made, so that there is an end. False where there is nothing to
  // do.
  bool work(std::int64_t number, Picoseconds until);

  std::int64_t recoveries() const { return recoveries_; }
  std::int64_t failed_attempts() const { return failed_attempts_; }
  std::int64_t given_up_at() const { return given_up_at_; }  // −1: was not
  // The last attempt's, if it failed.
  hvp_status last_failure() const { return failure_; }

 private:
  void fail(std::int64_t number, hvp_status status);

  const host::Recovery& policy_;
  FrameSolver& solver_;
  bool ready_ = true;
  hvp_status status_ = HVP_OK;
  hvp_status failure_ = HVP_OK;
  int failed_in_a_row_ = 0;
  std::int64_t next_attempt_ = 0;  // the frame from which on
  std::int64_t last_worked_ = -1;
  Picoseconds longest_piece_ = 0;
  std::int64_t recoveries_ = 0;
  std::int64_t failed_attempts_ = 0;
  std::int64_t given_up_at_ = -1;
};

}  // namespace hvp::vp
