#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <systemc>
#include <vector>

#include "models/host/costs.h"
#include "vp/board/board_side.h"
#include "vp/frame/frame.h"
#include "vp/frame/ledger.h"
#include "vp/function/config_space.h"
#include "vp/function/job_frames.h"
#include "vp/function/random_schedule.h"
#include "vp/host/board_access.h"
#include "vp/latency_draws.h"
#include "vp/platform_settings.h"

namespace hvp::vp {

// The delay between a function's interrupt and the host's handler: [host] interrupt_latency, or the
// draws of [host.interrupt_latencies] for the interrupts of a job. Interrupts keep their order.
// Each delay is a span of its frame, host interrupt, which ends when the handler runs.
class LateInterrupts : public sc_core::sc_module {
 public:
  // A message, or empty for a line that has gone up.
  using Message = std::optional<ConfigSpace::Message>;
  using Told = std::function<void(const Tag& tag, const Message& message)>;

  // `told` is called at its time, from within the simulation. Keeps a reference.
  LateInterrupts(const sc_core::sc_module_name& name, const host::Host& host, std::int64_t seed,
                 Ledger& ledger, Told told);

  // Raises an interrupt now.
  void raise(const Tag& tag, const Message& message);
  // The line has gone down before its interrupt was delivered.
  void forget_line();
  // Drops all interrupts, at a reset.
  void forget_all() { under_way_.clear(); }
  // No handler runs before this time.
  void hold_until(Picoseconds time) { held_until_ = time; }
  // Adds the next of these times to each interrupt's. To be called before the simulation begins.
  void delay_by(const RandomSchedule& schedule) { schedule_ = schedule; }

 private:
  struct UnderWay {
    Picoseconds raised = 0;
    Picoseconds due = 0;
    Tag tag;
    Message message;
  };

  void deliver();
  void follow(Tag& tag, Picoseconds raised);

  Picoseconds latency_;
  std::optional<LatencyDraws> draws_;
  std::optional<RandomSchedule> schedule_;
  Picoseconds held_until_ = 0;
  Ledger& ledger_;
  Told told_;
  std::deque<UnderWay> under_way_;
  sc_core::sc_event due_;
};

// A listener to the function's interrupts, which are reported at their times from within the
// simulation.
class InterruptListener {
 public:
  virtual ~InterruptListener() = default;
  virtual void message(const ConfigSpace::Message& message) = 0;
  virtual void line(bool up) = 0;
  // The function reports an uncorrectable error of PCI Express to the root port.
  virtual void error() {}
};

// A host that is not simulated: a program, or a kernel, that sees the board as a PCI function. It
// makes accesses to the BAR, which a process executes in order with their time on the bus; it reads
// and writes the configuration space; it gets interrupts; and it decides how far simulated time
// advances.
//
// An access to the configuration space takes no time of its own, and it overtakes no posted write
// (PCIe 5.0 §2.4.1; PCI 3.0 appendix E): it is made when those of the host before it have arrived,
// and a read is answered when those of the board before its answer have. So is one to the table of
// MSI-X in its BAR.
//
// An access to the BAR is a register's word, two of them, or a block of words. One that is not
// answered (no memory space, not in D0, beyond the BAR) reads all ones, takes no time and has no
// effect. The board refuses an access that is not whole words at a multiple of four
// (docs/registers.md).
class OutsideHost : public sc_core::sc_module, public InterruptIf {
 public:
  enum class Space : std::uint8_t { bar, configuration, message_table };
  struct Access {
    Command command = Command::read;
    Space space = Space::bar;
    std::uint64_t offset = 0;
    // The memory has to stay in place until `ended`.
    std::span<std::uint8_t> data;
    // Called when the answer has arrived or the write is done, at that time from within the
    // simulation.
    std::function<void()> ended;
  };

  // Sees all that passes between the host and the function, each at its time: the interrupts as the
  // host is told of them, and its accesses.
  class Observer : public InterruptListener {
   public:
    // The host has queued the access. A write has its data.
    virtual void asked(const Access& access) = 0;
    // The oldest access that has not ended has; a read has its data.
    virtual void ended(const Access& access) = 0;
    // The host's handler has returned, all that it wrote has arrived, and INTA# is still up.
    virtual void line_left_up() {}
    // The board has raised an interrupt that the function may not show.
    virtual void line_blocked() {}
    // The function was reset.
    virtual void board_was_reset() {}
    // A job of this number begins with the access that is about to be made.
    virtual void job_began(std::int64_t /*number*/) {}
  };

  // Keeps references. `side` was built with `settings` and is not connected yet.
  OutsideHost(const sc_core::sc_module_name& name, const PlatformSettings& settings,
              BoardSide& side, Session& session, Ledger& ledger);

  ConfigSpace& config() { return config_; }
  const ConfigSpace& config() const { return config_; }
  void listen(InterruptListener& listener) { listener_ = &listener; }
  // The host's handler has returned, and INTA# is up although nothing that it wrote is under way.
  void handler_left_line_up() {
    for (Observer* const observer : observers_) observer->line_left_up();
  }
  // Reports to `observer` too from now on. Keeps a reference.
  void observe(Observer& observer) { observers_.push_back(&observer); }
  // Delays each interrupt to the listener until this host's handler runs, [host] interrupt_latency
  // after it was raised. To be called before the simulation begins.
  void take_interrupts_late(const host::Host& host, std::int64_t seed);

  // For how long the host stands still behind the access that it has made now; access() lets that
  // time pass by itself.
  Picoseconds stall() { return schedule_ ? schedule_->next() : 0; }
  // It stands still from now until then, and takes no interrupt; stood_still() is to be called when
  // it goes on.
  void stands_still(Picoseconds until) {
    if (late_) late_->hold_until(until);
  }
  void stood_still();

  // From now on the bridge's errors are shown in the function's STATUS register, for a host that
  // reaches no register of a bridge. To be called before the simulation begins.
  void show_bus_errors() { shows_bus_errors_ = true; }

  // Makes this fault happen too, from now on. At any time, from within the simulation too.
  void inject(const Fault& fault);

  // Queues an access, to be made after those queued before. Called from outside any process.
  void post(Access access);
  bool idle() const { return accesses_.empty(); }
  // The number of the job that this access begins when it is made, behind those that are queued;
  // none: it begins none.
  std::optional<std::int64_t> begins_job(const Access& access) const;
  // Simulates up to this time, including its events, or until something has happened that may
  // concern the host: an access has ended, or an interrupt was raised or lowered. Returns true if
  // the time was reached.
  bool run_until(Picoseconds time);
  // Ends run_until() as if something had happened that concerns the host.
  void come_back() { something_happened(); }
  // Posts an access and simulates until its answer, and then for stall(). Returns false if no
  // further event could bring one.
  bool access(Command command, std::uint64_t offset, std::span<std::uint8_t> data,
              Space space = Space::bar);

  // Between these, as within a call-back of the simulation, no time can pass: accesses read ones
  // and have no effect, and a wait ends at once.
  void hold_time() { ++held_; }
  void release_time() { --held_; }

  // True if the function was pulled out.
  bool removed() const;

  // True if INTA# is up, as the host sees it.
  bool line_is_up() const { return line_shown_; }
  // How often the host was told of a message, and of a line that has gone up.
  std::int64_t messages() const { return messages_; }
  std::int64_t lines() const { return lines_; }
  JobFrames& frames() { return frames_; }

  // InterruptIf
  void interrupt(const Tag& tag) override;
  void lowered() override;

 private:
  void before_end_of_elaboration() override;
  void serve();
  void make(const Access& access);
  void configure(const Access& access);
  void listen_to(FaultPlan& faults);
  void packet_error(FaultKind kind);
  void take_away();
  void note_bus_errors();
  void tell(const LateInterrupts::Message& message);
  void tell_line(bool up);
  void raised(const Tag& tag, const LateInterrupts::Message& message);
  void tell_of_births();
  void tell_plan();
  void update_interrupts();
  void reset_function();
  void something_happened();

  BoardSide& side_;
  ConfigSpace config_;
  BoardAccess access_;
  JobFrames frames_;
  Ledger& ledger_;
  InterruptListener* listener_ = nullptr;
  std::vector<Observer*> observers_;
  std::int64_t seed_;
  std::optional<double> longest_stall_s_;
  std::optional<LateInterrupts> late_;
  std::optional<RandomSchedule> schedule_;
  std::deque<Access> accesses_;
  bool first_is_made_ = false;  // it has begun and not ended
  sc_core::sc_event posted_;
  Tag tag_;                     // the last interrupt's
  bool taken_away_ = false;     // the function was pulled out
  bool board_line_ = false;     // the board's state of the line
  bool line_shown_ = false;     // the host's view of the line
  bool pending_ = false;        // a masked message is pending
  std::int64_t told_jobs_ = 0;  // of which others know the births
  std::int64_t messages_ = 0;
  std::int64_t lines_ = 0;
  bool shows_bus_errors_ = false;
  bool running_ = false;
  bool happened_ = false;
  int held_ = 0;
};

// The board's side for a host of another program, built and wired, as the C library hvp-board, `hvp
// serve` and `hvp linux` use it. SystemC elaborates once in a process, so there is one a process.
// The host's memory is empty until the host maps some (HostMemory::map()); the scenario's own host
// and its effects, such as [host] and [hand], have no meaning here.
class BoardFunction {
 public:
  explicit BoardFunction(const PlatformSettings& settings, AccessObserver* register_trace = nullptr)
      : settings_(settings),
        side_(settings_, Workload{}, session_, ledger_, register_trace),
        host_("host", settings_, side_, session_, ledger_) {}

  OutsideHost& host() { return host_; }
  ConfigSpace& config() { return host_.config(); }
  // Null if the board is not a bus master.
  HostMemory* memory() { return side_.board()->memory(); }
  Accelerator& accelerator() { return side_.board()->accelerator(); }
  const Accelerator& accelerator() const { return side_.board()->accelerator(); }
  BusErrors& bus_errors() { return side_.board()->bus_errors(); }
  Ledger& ledger() { return ledger_; }
  const Session& session() const { return session_; }
  BoardSide& side() { return side_; }

 private:
  PlatformSettings settings_;
  Ledger ledger_;
  Session session_;
  BoardSide side_;
  OutsideHost host_;
};

}  // namespace hvp::vp
