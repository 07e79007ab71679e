#pragma once

#include <cstddef>
#include <cstdint>
#include <systemc>

#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/tlm_quantumkeeper.h>

#include "models/host/costs.h"
#include "vp/bus/host_memory.h"
#include "vp/frame/frame_tag.h"
#include "vp/frame/ledger.h"

namespace hvp::vp {

// The temporal decoupling of the servo process (IEEE 1666-2011 §12.1): the time of its work runs
// ahead of the kernel, by at most the global quantum. Nothing observable between parts happens
// ahead: every bus access, every wait and every exchange between processes synchronises first. The
// quantum therefore affects wall time only; with a quantum of zero each step synchronises.
class LocalTime {
 public:
  static void set_quantum(Picoseconds quantum) {
    tlm_utils::tlm_quantumkeeper::set_global_quantum(to_sc_time(quantum));
  }

  Picoseconds now() const { return static_cast<Picoseconds>(keeper_.get_current_time().value()); }
  // Spends time. Called in the servo process.
  void advance(Picoseconds time) {
    keeper_.inc(to_sc_time(time));
    if (keeper_.need_sync()) keeper_.sync();
  }
  void synchronise() {
    if (ahead() != sc_core::SC_ZERO_TIME) keeper_.sync();
  }

  // The time by which the process is ahead, which a transaction carries as its annotated delay. The
  // bus has waited for it on return, and restart() begins from there.
  sc_core::sc_time ahead() const { return keeper_.get_local_time(); }
  void restart() { keeper_.reset(); }

 private:
  tlm_utils::tlm_quantumkeeper keeper_;
};

// The servo process' computing time: host spans that follow the tag.
class Work {
 public:
  Work(const host::Host& costs, bool untimed, Tag& tag, LocalTime& time, Ledger& ledger)
      : costs_(costs), untimed_(untimed), tag_(tag), time_(time), ledger_(ledger) {}

  void spend(Phase phase, double seconds, double operations = 0) const {
    if (untimed_) return;
    const Picoseconds start = time_.now();
    time_.advance(to_picoseconds(seconds) + costs_.compute_ps(operations));
    // A frame that is kept open gets spans from others too: synchronise, so that the spans stay in
    // the order of time.
    if (ledger_.holds()) time_.synchronise();
    ledger_.extend(tag_, Part::host, phase, start, time_.now());
  }
  Picoseconds now() const { return time_.now(); }
  const host::Host& costs() const { return costs_; }
  Tag& tag() const { return tag_; }

 private:
  host::Host costs_;
  bool untimed_;
  Tag& tag_;
  LocalTime& time_;
  Ledger& ledger_;
};

// The processor's accesses to the bus, and the receiver of the solver board's interrupts. Each
// access is a transaction in the caller's process with the current frame's tag.
class BoardAccess : public sc_core::sc_module, public InterruptIf {
 public:
  // With `messages`, interrupts are edges, and the wait that one ends takes it; otherwise the line
  // stays up until the board lowers it.
  explicit BoardAccess(const sc_core::sc_module_name& name, bool messages = false);
  ~BoardAccess() override;

  tlm_utils::simple_initiator_socket<BoardAccess> to_bus;

  // The frame that accesses are for, and its newest span.
  Tag& tag() { return tag_; }
  // The servo process' own time.
  LocalTime& time() { return time_; }

  // A single access to any board. Returns false if no target answered.
  bool write(std::uint64_t address, const void* data, std::size_t bytes);
  bool read(std::uint64_t address, void* data, std::size_t bytes);
  // As read(), for the tag's frame but without a span.
  bool look(std::uint64_t address, void* data, std::size_t bytes);

  bool has_interrupt() const { return has_interrupt_; }
  const sc_core::sc_event& interrupted() const { return interrupted_; }
  // Takes the interrupt that ended a wait.
  void take_interrupt() { has_interrupt_ = has_interrupt_ && !messages_; }
  // If the interrupt was raised for the current frame, the frame's next span follows the board's.
  void follow_interrupt();

  // InterruptIf
  void interrupt(const Tag& tag) override;
  void lowered() override { has_interrupt_ = false; }

 private:
  bool transport(tlm::tlm_command command, std::uint64_t address, unsigned char* data,
                 std::size_t bytes);

  bool messages_;
  Tag tag_;
  LocalTime time_;
  tlm::tlm_generic_payload payload_;
  FrameTag extension_;
  bool has_interrupt_ = false;
  Tag interrupt_tag_;
  sc_core::sc_event interrupted_;
};

}  // namespace hvp::vp
