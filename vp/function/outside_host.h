#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <systemc>

#include "vp/board/board_side.h"
#include "vp/frame/ledger.h"
#include "vp/frame/session.h"
#include "vp/function/config_space.h"
#include "vp/function/job_frames.h"
#include "vp/function/late_interrupts.h"
#include "vp/host/board_access.h"

namespace hvp::vp {

// Who is told of the function's interrupts, at their times, from within the simulation.
class InterruptListener {
 public:
  virtual ~InterruptListener() = default;
  virtual void message(const ConfigSpace::Message& message) = 0;
  virtual void line(bool up) = 0;
};

// A host that is not simulated: a program, or a kernel, that sees the board as a PCI function. It
// gives accesses to the BAR, which a process makes one after the other with their time on the bus;
// it reads and writes the configuration space, at once; it hears of interrupts; and it says how far
// simulated time may go.
//
// An access to the BAR is a register's word, two of them, or a block of words. One that is not
// answered (no memory space, not in D0, beyond the BAR) reads all ones, takes no time and has no
// effect. What is not whole words at a multiple of four is the board's to refuse
// (docs/registers.md).
class OutsideHost : public sc_core::sc_module, public InterruptIf {
 public:
  struct Access {
    Command command = Command::read;
    std::uint64_t offset = 0;
    // Stays where it is until `ended`.
    std::span<std::uint8_t> data;
    // The answer is there, or the write is done; at that time, from within the simulation.
    std::function<void()> ended;
  };

  // Keeps references. The side is that of `settings`, not connected yet.
  OutsideHost(const sc_core::sc_module_name& name, const PlatformSettings& settings,
              BoardSide& side, Session& session, Ledger& ledger);

  ConfigSpace& config() { return config_; }
  const ConfigSpace& config() const { return config_; }
  void listen(InterruptListener& listener) { listener_ = &listener; }
  // From now on the listener is told of an interrupt when this host's handler runs, the scenario's
  // [host] interrupt_latency after it was raised. Before the simulation begins.
  void take_interrupts_late(const host::Host& host, std::int64_t seed);

  // From outside any process; those before it are made first.
  void post(Access access);
  bool idle() const { return accesses_.empty(); }
  // Simulates up to this time, events at it included, or until something has happened that the
  // host may want to know: an access has ended, or an interrupt was raised or lowered. Returns
  // whether the time was reached.
  bool run_until(Picoseconds time);
  // Both at once, for a host that waits for its answer. False where nothing could answer any more.
  bool access(Command command, std::uint64_t offset, std::span<std::uint8_t> data);

  // Whether INTA# is up, as the host sees it.
  bool line_is_up() const { return line_shown_; }
  JobFrames& frames() { return frames_; }

  // InterruptIf
  void interrupt(const Tag& tag) override;
  void lowered() override;

 private:
  void serve();
  void make(const Access& access);
  void tell(const LateInterrupts::Message& message);
  void raised(const Tag& tag, const LateInterrupts::Message& message);
  void begin_faults();
  void update_interrupts();
  void reset_function();
  void something_happened();

  BoardSide& side_;
  const Session& session_;
  ConfigSpace config_;
  BoardAccess access_;
  JobFrames frames_;
  Ledger& ledger_;
  InterruptListener* listener_ = nullptr;
  std::optional<LateInterrupts> late_;
  std::deque<Access> accesses_;
  sc_core::sc_event posted_;
  Tag tag_;                  // of the last interrupt
  bool board_line_ = false;  // what the board does
  bool line_shown_ = false;  // what the host sees of it
  bool pending_ = false;     // a message that is masked
  bool faults_begun_ = false;
  bool running_ = false;
  bool happened_ = false;
};

}  // namespace hvp::vp
