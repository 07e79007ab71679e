#include "vp/host/board_recovery.h"

#include <algorithm>

namespace hvp::vp {

void BoardRecovery::begin(std::int64_t number, hvp_status status) {
  ready_ = false;
  status_ = status;
  next_attempt_ = number;
}

bool BoardRecovery::work(std::int64_t number, Picoseconds until) {
  failure_ = HVP_OK;
  if (ready_ || given_up() || number < next_attempt_) return false;
  const bool first = last_worked_ != number;
  if (!first && now_ps() + longest_piece_ > until) return false;
  last_worked_ = number;
  const Picoseconds began = now_ps();
  bool done = false;
  const hvp_status status = solver_.set_up_piece(done);
  longest_piece_ = std::max(longest_piece_, now_ps() - began);
  if (status != HVP_OK) {
    fail(number, status);
    return false;
  }
  if (!done) return true;
  ready_ = true;
  failed_in_a_row_ = 0;
  ++recoveries_;
  return false;
}

void BoardRecovery::fail(std::int64_t number, hvp_status status) {
  status_ = status;
  failure_ = status;
  ++failed_attempts_;
  ++failed_in_a_row_;
  if (failed_in_a_row_ == policy_.attempts) {
    given_up_at_ = number;
  } else {
    next_attempt_ = number + policy_.back_off(failed_in_a_row_);
  }
}

}  // namespace hvp::vp
