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
// prepares it until the last one before the next job is prepared, or until the host ran with the
// job's end in its memory. The host's own time between two accesses is a span too, so that the
// spans sum to the frame's time, and the chain of causes goes through the board when the host
// waited for it. A frame fails as the board's words tell a driver (hvp_status.h), whatever the
// driver makes of them.
class JobFrames {
 public:
  // Keeps references. `tag` is what the accesses carry.
  JobFrames(Ledger& ledger, Session& session, Tag& tag)
      : ledger_(ledger), session_(session), tag_(tag) {}

  // The source of the jobs' ends, so that a polling host has them too, and of what the board does.
  void watch(const Accelerator& board) {
    board_ = &board;
    job_end_ = &board.job_end();
  }
  // The jobs as the next access finds them, and what it makes of them: true if it begins one.
  struct Ahead {
    bool is_open = false;
    bool started = false;
    std::int64_t next = 0;  // the number of the next job
    bool follow(Step step);
  };
  Ahead ahead() const { return {is_open(), started_, next_}; }
  // The step of an access that would be made now: what the board refuses is of the job under way.
  Step step_now(Command command, std::uint64_t offset, std::span<const std::uint8_t> data) const;
  // To be called at the time of the access, before it is made.
  void before(Command command, std::uint64_t offset, std::span<const std::uint8_t> data);
  // The host got the interrupt of a job's end; `tag` is the interrupt's. One of an earlier job,
  // which comes late, has the host look all the same.
  void heard(const Tag& tag) {
    heard_ = tag;
    if (!heard()) looked();
  }
  // The host's own clock has woken it for a new period: the next job's frame is born now instead of
  // at its first access, unless a frame was born or was at work since. If the host still waits for
  // a job, the wake-up belongs to another period or to the clock itself.
  void woke(Picoseconds time) {
    if (!waits_for_a_job()) woke_ = time;
  }
  // The host looked, at this time, at what the board had written to its memory: a job by DMA whose
  // end is there is over.
  void looked();
  // The host took an interrupt: it waits for its job again, or still.
  void took() { busy_ = false; }
  // The host ran at this time, and nobody knows what for. A job of which it then makes no access
  // any more was over when it last ran before the next one: it waited for an interrupt that never
  // came.
  void ran() { ran_ = now_ps(); }
  // The host stood still until now, behind its last access. That is of the frame whose end it
  // knows.
  void stood_still() {
    if (is_open() && followed_) account_for_host(Phase::driver, now_ps());
  }
  // What an access told the host, at the access' end: all ones, an error, or the end of another job
  // in STATUS are an open job's failure.
  void answered(std::uint64_t offset, std::span<const std::uint8_t> data);
  // The bus told the host that the last access failed. It is a failure of the open job unless that
  // was an acknowledgement which the host repeats.
  void told_by_bus(hvp_status status);
  // The board has forgotten its job: it was reset by other ways than an access.
  void board_was_reset();
  // The host goes no further: a job whose end it does not know is none, whatever the board does,
  // and neither is one that begins now.
  void stop() {
    if (!stopped_) known_ = is_open() && (followed_ || heard()) ? tag_.frame : -1;
    stopped_ = true;
  }
  // No job follows. An unfinished job is a frame only if it fails: the host was told so, or has
  // given it up.
  void finish(bool given_up = false);

  // The number of jobs so far, including the open one.
  std::int64_t jobs() const { return next_; }
  bool is_open() const { return tag_.frame >= 0; }
  Picoseconds newest_birth() const { return born_; }

 private:
  void open();
  // The first failure is the frame's.
  void told(hvp_status status);
  // The host has gone on; it gave the job up if the last that it heard was that the board is busy.
  void close(bool may_have_given_up);
  bool heard() const { return heard_.frame == tag_.frame; }
  bool ended() const { return job_end_ != nullptr && job_end_->tag.frame == tag_.frame; }
  // True while the board refuses what belongs to a next job.
  bool refuses_a_job() const {
    return started_ && board_ != nullptr && board_->bank().get(field::kStatusBusy) != 0;
  }
  // True as far as the host can know.
  bool waits_for_a_job() const { return tag_.frame >= 0 && started_ && !followed_ && !heard(); }
  void settle();
  std::optional<Phase> follow_the_board();
  void account_for_host(Phase phase, Picoseconds until);
  Picoseconds last_end() const;

  Ledger& ledger_;
  Session& session_;
  Tag& tag_;
  const Accelerator* board_ = nullptr;
  const JobEnd* job_end_ = nullptr;
  Tag heard_;
  Picoseconds woke_ = -1;
  Picoseconds ran_ = -1;
  Picoseconds born_ = -1;   // the newest frame's birth
  Picoseconds ended_ = -1;  // the last closed frame's end
  std::int64_t next_ = 0;
  bool acknowledges_ = false;          // with the last access
  bool lost_acknowledgement_ = false;  // the frame's failure is only that
  bool started_ = false;
  bool listed_ = false;  // the job's end is in the host's memory too
  bool busy_ = false;    // the host's last look said so
  bool followed_ = false;
  bool stopped_ = false;
  std::int64_t known_ = -1;  // the job whose end the host knew then
};

}  // namespace hvp::vp
