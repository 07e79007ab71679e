#pragma once

#include <cstdint>

namespace hvp::host {

// One core for two processes: the servo process preempts the collision and graphics process. All
// times are in ps; nothing here waits, the simulation asks for the times.
//
// Rules. A core that goes directly from one process to the other is switched, which takes
// `context_switch`; a core that was idle in between is not. The other process' work has sections
// that cannot be preempted: the first `section` of every `section_every` of its own processor time.
// A preemption loses a switch that is not over. The result of events at one instant does not depend
// on which process asks first: work that ends then has ended, a section that begins then has not
// begun, and a process that got the core then has not used it yet.
class SharedCore {
 public:
  struct Settings {
    std::int64_t context_switch = 0;
    std::int64_t section = 0;        // 0: everything can be preempted
    std::int64_t section_every = 1;  // at least `section`
  };
  explicit SharedCore(const Settings& settings) : settings_(settings) {}

  // Called when the servo process is ready: the time until which the other process blocks it, and
  // the time at which it runs.
  struct Dispatch {
    std::int64_t unblocked;
    std::int64_t runs;
    bool preempts;  // the other process loses the core at `unblocked`
  };
  Dispatch servo_ready(std::int64_t now);
  void servo_sleeps(std::int64_t now);
  bool servo_has_it() const { return servo_; }

  // The other process takes a core that the servo process does not use. Returns the time of its
  // first instruction.
  std::int64_t other_takes(std::int64_t now);
  // Called at that instruction, of a new piece of work or of the rest of one.
  void other_begins(std::int64_t now, std::int64_t work);
  void other_resumes(std::int64_t now);
  // False once the other process has lost the core or ended.
  bool other_has_it() const { return other_ != Other::away; }
  // The time at which its work is over if it is not preempted.
  std::int64_t other_ends() const { return since_ + work_ - done_; }
  // True where its work is over; it then leaves the core.
  bool other_done(std::int64_t now);
  // The processor time that it had used since it began, when it lost the core.
  std::int64_t other_progress() const { return done_; }

 private:
  enum class Other { away, switching, running };

  std::int64_t held_up(std::int64_t progress) const;

  Settings settings_;
  bool servo_ = true;  // set-up belongs to the servo process
  std::int64_t servo_left_ = -1;
  Other other_ = Other::away;
  std::int64_t other_left_ = -1;
  std::int64_t took_ = -1;
  std::int64_t since_ = 0;  // time of the instruction with which it went on
  std::int64_t done_ = 0;
  std::int64_t work_ = 0;
};

}  // namespace hvp::host
