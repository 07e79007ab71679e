#include "models/host/shared_core.h"

#include <algorithm>

namespace hvp::host {

// The rest of the section that the other process is in.
std::int64_t SharedCore::held_up(std::int64_t progress) const {
  const std::int64_t offset = progress % settings_.section_every;
  if (offset == 0 || offset >= settings_.section) return 0;
  return std::min(settings_.section - offset, work_ - progress);
}

SharedCore::Dispatch SharedCore::servo_ready(std::int64_t now) {
  servo_ = true;
  const std::int64_t switched = now + settings_.context_switch;
  const std::int64_t after_idle = other_left_ == now ? switched : now;
  if (other_ == Other::away) return {now, after_idle, false};
  const bool had_it = took_ < now;
  const std::int64_t progress =
      other_ == Other::running ? done_ + std::max<std::int64_t>(now - since_, 0) : 0;
  const bool running = other_ == Other::running;
  other_ = Other::away;
  if (!had_it) return {now, after_idle, true};
  if (!running) return {now, switched, true};
  if (progress >= work_) {
    done_ = work_;
    other_left_ = now;
    return {now, switched, false};
  }
  const std::int64_t wait = held_up(progress);
  done_ = progress + wait;
  return {now + wait, switched + wait, true};
}

void SharedCore::servo_sleeps(std::int64_t now) {
  servo_ = false;
  servo_left_ = now;
}

std::int64_t SharedCore::other_takes(std::int64_t now) {
  took_ = now;
  other_ = Other::switching;
  since_ = now + (servo_left_ == now ? settings_.context_switch : 0);
  return since_;
}

void SharedCore::other_begins(std::int64_t now, std::int64_t work) {
  work_ = work;
  done_ = 0;
  other_resumes(now);
}

void SharedCore::other_resumes(std::int64_t now) {
  other_ = Other::running;
  since_ = now;
}

bool SharedCore::other_done(std::int64_t now) {
  if (other_ == Other::running && now >= other_ends()) {
    done_ = work_;
    other_ = Other::away;
    other_left_ = now;
  }
  return other_ == Other::away && done_ == work_;
}

}  // namespace hvp::host
