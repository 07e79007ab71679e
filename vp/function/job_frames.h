#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "vp/fpga/accelerator.h"
#include "vp/frame/ledger.h"
#include "vp/frame/session.h"

namespace hvp::vp {

// What an access is to the order of a job.
enum class Step : std::uint8_t {
  other,    // belongs to the job that is open, where there is one
  prepare,  // b, or a change of a row: of the job that comes
  start,    // the job's start, or the doorbell
  set_up,   // settings, a matrix, a reset: of no job
};
Step step_of(Command command, std::uint64_t offset, std::span<const std::uint8_t> data);

// The frames of a host that knows of none: each job is one, from the first access that prepares it
// until the last one before the next job is prepared. Whatever the host does between two accesses
// is a span of it as well, so that its spans sum to its time, and the chain of causes goes through
// the board where the host waited for it.
class JobFrames {
 public:
  // Keeps references. `tag` is what the accesses carry.
  JobFrames(Ledger& ledger, Session& session, Tag& tag)
      : ledger_(ledger), session_(session), tag_(tag) {}

  // Jobs that end are looked up here, so that a host that polls has them too.
  void watch(const JobEnd& job_end) { job_end_ = &job_end; }
  // Now, before the access is made.
  void before(Step step);
  // The host has heard of the end, by an interrupt for this tag's work.
  void heard(const Tag& tag) { heard_ = tag; }
  // The host's own clock has woken it, for a period that begins: the next job's frame is born here
  // and not at its first access, if no frame was since. Where the host still waits for a job it is
  // another's period, or the clock's own.
  void woke(Picoseconds time) {
    if (!waits_for_a_job()) woke_ = time;
  }
  // No job follows. One that is not over is no frame.
  void finish();

  // Jobs so far, the open one included.
  std::int64_t jobs() const { return next_; }

 private:
  void open();
  void close();
  // As far as the host can know.
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
  Picoseconds born_ = -1;  // the newest frame
  std::int64_t next_ = 0;
  bool started_ = false;
  bool followed_ = false;
};

}  // namespace hvp::vp
