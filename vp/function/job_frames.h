#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "vp/fpga/accelerator.h"
#include "vp/frame/frame.h"
#include "vp/frame/ledger.h"

namespace hvp::vp {

// The kind of an access in the order of a job.
enum class Step : std::uint8_t {
  other,    // belongs to the open job, if there is one
  prepare,  // b, or a change of a row, for the next job
  start,    // the job's start, or the doorbell
  set_up,   // settings, a matrix, a reset; belongs to no job
};
Step step_of(Command command, std::uint64_t offset, std::span<const std::uint8_t> data);

// The frames of a host that does not know frames. Each job is one, from the first access that
// prepares it until the last one before the next job is prepared. The host's own time between two
// accesses is a span too, so that the spans sum to the frame's time, and the chain of causes goes
// through the board when the host waited for it.
class JobFrames {
 public:
  // Keeps references. `tag` is what the accesses carry.
  JobFrames(Ledger& ledger, Session& session, Tag& tag)
      : ledger_(ledger), session_(session), tag_(tag) {}

  // The source of the jobs' ends, so that a polling host has them too.
  void watch(const JobEnd& job_end) { job_end_ = &job_end; }
  // To be called at the time of the access, before it is made.
  void before(Step step);
  // The host got the interrupt of a job's end; `tag` is the interrupt's.
  void heard(const Tag& tag) { heard_ = tag; }
  // The host's own clock has woken it for a new period: the next job's frame is born now instead of
  // at its first access, unless a frame was born since. If the host still waits for a job, the
  // wake-up belongs to another period or to the clock itself.
  void woke(Picoseconds time) {
    if (!waits_for_a_job()) woke_ = time;
  }
  // No job follows. An unfinished job is not a frame.
  void finish();

  // The number of jobs so far, including the open one.
  std::int64_t jobs() const { return next_; }

 private:
  void open();
  void close();
  // True as far as the host can know.
  bool waits_for_a_job() const {
    return tag_.frame >= 0 && started_ && !followed_ && heard_.frame != tag_.frame;
  }
  std::optional<Phase> follow_the_board();
  void account_for_host(Phase phase);
  Picoseconds last_end() const;

  Ledger& ledger_;
  Session& session_;
  Tag& tag_;
  const JobEnd* job_end_ = nullptr;
  Tag heard_;
  Picoseconds woke_ = -1;
  Picoseconds born_ = -1;  // the newest frame's birth
  std::int64_t next_ = 0;
  bool started_ = false;
  bool followed_ = false;
};

}  // namespace hvp::vp
