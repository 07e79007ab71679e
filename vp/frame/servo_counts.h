#pragma once

#include <array>
#include <cstdint>

#include "driver/hvp_status.h"

namespace hvp::vp {

// Errors that the driver has put right, at the cost of time only.
struct Mended {
  int lost_interrupts = 0;
  int lost_acknowledgements = 0;
  // The frames whose acknowledgements were lost: the one that is worked on, and an earlier one.
  // −1: none.
  std::int64_t unacknowledged_here = -1;
  std::int64_t unacknowledged_before = -1;
  int aborted = 0;  // accesses that were repeated
  int damaged = 0;  // accesses with a damaged word
};

struct ErrorCount {
  std::int64_t count = 0;
  std::int64_t first_frame = -1;  // −1: before the first frame
};

// The counts of errors in the servo loop that the ledger does not have.
struct ServoCounts {
  std::int64_t clamped_words = 0;   // of right-hand sides, outside the words' range
  std::int64_t clamped_forces = 0;  // frames whose force was outside the device register's range
  std::int64_t driver_errors = 0;   // frames whose solve failed, so that a held force went out
  std::int64_t held_frames = 0;     // those, and the frames while the board was not available
  std::int64_t longest_hold = 0;    // ticks in a row without a new force, skipped ones included
  // By the status that the driver returned: frames, repeated accesses and failed set-ups.
  std::array<ErrorCount, HVP_STATUS_COUNT> errors{};
  Mended mended;
  std::int64_t recoveries = 0;  // times that the board was set up again
  std::int64_t failed_set_ups = 0;
  std::int64_t given_up_at = -1;     // the frame in which the board was given up; −1: never
  std::int64_t contact_changes = 0;  // frames in which a probe touches another node than before
  std::uint32_t flags = 0;           // stability::Flags of all solves
  hvp_status last_error = HVP_OK;
};

}  // namespace hvp::vp
