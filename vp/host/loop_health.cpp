#include "vp/host/loop_health.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <spdlog/spdlog.h>

#include "vp/frame/frame_tag.h"

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

namespace {
std::uint32_t bit(stability::Flag flag) { return std::uint32_t{1} << static_cast<unsigned>(flag); }

// Errors of a board that is present, which may do better at the next attempt.
bool may_pass(hvp_status status) {
  return status == HVP_ERROR_NO_DEVICE || status == HVP_ERROR_BUS || status == HVP_ERROR_DATA ||
         status == HVP_ERROR_TIMEOUT || status == HVP_ERROR_BOARD;
}
}  // namespace

stability::Flag flag_of(hvp_status status) {
  switch (status) {
    case HVP_ERROR_SATURATED:
      return stability::Flag::saturation;
    case HVP_ERROR_TIMEOUT:
    case HVP_ERROR_INTERRUPTED:
      return stability::Flag::solver_timeout;
    case HVP_ERROR_BUS:
    case HVP_ERROR_DATA:
    case HVP_ERROR_DMA:
    case HVP_ERROR_SHORT_TRANSFER:
    case HVP_ERROR_STALE_RESULT:  // the start or the record did not arrive
    case HVP_ERROR_NO_DEVICE:
      return stability::Flag::bus_error;
    default:
      return stability::Flag::board_error;
  }
}

void LoopHealth::set_up_failed(hvp_status status, int failed) {
  note(status, -1);
  notice_failure(0);
  if (failed == policy_.attempts || !may_pass(status)) {
    throw std::runtime_error(std::string("the board could not be set up: ") +
                             hvp_status_text(status));
  }
  ++counts_.failed_set_ups;
}

void LoopHealth::loop_begins(Picoseconds now) {
  if (faults_ != nullptr) faults_->begin(now);
}

// An earlier error says more than that a lost board cannot be closed.
void LoopHealth::closed(hvp_status status, std::int64_t ticks) {
  if (counts_.last_error == HVP_OK) note(status, ticks);
  // The ticks that the last frame skipped.
  count_ticks_without_force(ticks);
}

void LoopHealth::solve_ended(const SolveEnd& end, std::uint32_t& flags) {
  count_mended(end.frame);
  if ((flags & bit(stability::Flag::saturation)) != 0) {
    notice(FaultKind::saturated_solve, end.frame);
  }
  count_ticks_without_force(end.status == HVP_OK ? end.frame : end.frame + 1);
  if (end.status == HVP_OK) {
    last_solved_ = end.frame;
    // A transfer that was only late is in the frame's latency.
    notice(FaultKind::late_dma, end.frame);
    return;
  }
  flags |= bit(flag_of(end.status));
  ++counts_.held_frames;
  if (end.attempted) fail(end);
}

void LoopHealth::fail(const SolveEnd& end) {
  note(end.status, end.frame);
  ++counts_.driver_errors;
  notice_failure(end.frame);
  if (!solver_.survives(end.status)) lose(end.status, end.frame);
}

void LoopHealth::lose(hvp_status status, std::int64_t frame) {
  lost_contact_ = true;
  recovery_.begin(frame, status);
}

void LoopHealth::failed_after_force(hvp_status status, std::int64_t frame, std::uint32_t& flags) {
  count_mended(frame);
  flags |= bit(flag_of(status));
  note(status, frame);
  notice_failure(frame);
  if (!solver_.survives(status)) lose(status, frame);
}

// Counts the errors that the driver has put right in the meantime.
void LoopHealth::count_mended(std::int64_t frame) {
  const Mended mended = solver_.take_mended();
  counts_.mended.lost_interrupts += mended.lost_interrupts;
  counts_.mended.lost_acknowledgements += mended.lost_acknowledgements;
  counts_.mended.aborted += mended.aborted;
  counts_.mended.damaged += mended.damaged;
  count(HVP_ERROR_BUS, frame, mended.aborted);
  count(HVP_ERROR_DATA, frame, mended.damaged);
  if (mended.lost_interrupts > 0) notice(FaultKind::lost_interrupt, frame);
  for (const std::int64_t of : {mended.unacknowledged_before, mended.unacknowledged_here}) {
    if (of < 0) continue;
    notice(FaultKind::master_abort, of);
    notice(FaultKind::aer_uncorrectable, of);
  }
  if (mended.aborted > 0) notice(FaultKind::master_abort, frame);
  if (mended.damaged > 0) notice(FaultKind::corrupted_word, frame);
  if (mended.aborted > 0 || mended.damaged > 0) notice(FaultKind::aer_uncorrectable, frame);
}

// The ticks before `until` that had none since the last solved frame.
void LoopHealth::count_ticks_without_force(std::int64_t until) {
  counts_.longest_hold = std::max(counts_.longest_hold, until - last_solved_ - 1);
}

// A piece after the other.
void LoopHealth::recover(std::int64_t frame, Picoseconds until) {
  while (recovery_.work(frame, until)) {
  }
  if (const hvp_status failed = recovery_.last_failure(); failed != HVP_OK) {
    note(failed, frame);
    notice_failure(frame);
  }
  counts_.recoveries = recovery_.recoveries();
  counts_.failed_set_ups = recovery_.failed_attempts();
  counts_.given_up_at = recovery_.given_up_at();
  if (recovery_.given_up()) {
    spdlog::error("the board was given up in frame {}: {}", frame,
                  hvp_status_text(counts_.last_error));
  }
}

void LoopHealth::note(hvp_status status, std::int64_t frame) {
  if (status == HVP_OK) return;
  counts_.last_error = status;
  count(status, frame, 1);
}

void LoopHealth::count(hvp_status status, std::int64_t frame, std::int64_t times) {
  ErrorCount& error = counts_.errors[static_cast<std::size_t>(status)];
  if (times > 0 && error.count == 0) error.first_frame = frame;
  error.count += times;
}

}  // namespace hvp::vp
