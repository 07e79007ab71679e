#pragma once

#include <array>
#include <cstdint>

#include "models/link/direction.h"
#include "models/link/pci.h"

namespace hvp::link {

// A PCI bus with several masters, exact to the clock: which of them owns it, when, and for how many
// data phases. It has no clock of its own; its user says how far time has come.
//
//   arbiter.request(master, Direction::read, 64, now);
//   …wait until arbiter.forecast(master), or until somebody else requests…
//   arbiter.advance(now);  arbiter.done(master)
//
// Rules. A request is seen at the first clock edge at or after it. Arbitration is hidden behind the
// running transaction. The winner of simultaneous requests follows from the policy and the masters'
// numbers, never from the order of the calls: a grant at an instant is decided only once time has
// passed it. A master asks for its next burst when its last one has released the bus. A burst whose
// GNT# is gone and whose latency timer has run out ends with the present data phase (PCI 3.0
// §3.5.4), and the rest of it goes on in a later tenure.
//
// Value semantics, and nothing allocates: forecast() runs a copy.
class PciArbiter {
 public:
  static constexpr int kMaxMasters = 8;

  struct Statistics {
    std::int64_t tenures = 0;
    std::int64_t retries = 0;
    std::int64_t preemptions = 0;
    std::int64_t bytes = 0;
    std::int64_t owned_ps = 0;    // address phase to turnaround
    std::int64_t waiting_ps = 0;  // REQ# to address phase
  };

  // Gets every tenure of a master, from its address phase to its turnaround, in the order of time.
  // Forecasts do not call it.
  class Observer {
   public:
    virtual ~Observer() = default;
    virtual void owned(int master, std::int64_t start_ps, std::int64_t end_ps) = 0;
  };

  // Throws InputError for less than one or more than kMaxMasters masters.
  PciArbiter(const Pci& bus, const PciProtocol& protocol, int masters);

  void report_to(Observer& observer) { observer_ = &observer; }

  // The master has no request under way, bytes > 0, and `time_ps` is not before the last advance().
  void request(int master, Direction direction, std::int64_t bytes, std::int64_t time_ps);
  // Brings the bus forward to this time.
  void advance(std::int64_t time_ps);
  // Occupies the bus until `until_ps` for a target whose transaction has just released it. To be
  // called at the time of the last advance(), by which the bus was released. `master` is the
  // transaction's.
  void hold(int master, std::int64_t until_ps);
  std::int64_t held_ps() const { return held_ * clocks_.period_ps(); }
  // The time for which the bus was owned or occupied until `until_ps`, which is not before the last
  // advance().
  std::int64_t taken_ps(std::int64_t until_ps) const;
  // A master's part of that, without held_ps(). What of a hold comes after `until_ps` is taken off
  // the master that holds: its owned and its held time sum to what it had by then.
  std::int64_t owned_ps(int master, std::int64_t until_ps) const;
  bool busy(int master) const { return at(master).busy; }
  // True if the master's last request has released the bus by the time of the last advance().
  bool done(int master) const { return !at(master).busy; }
  // The time at which the last completed request released the bus.
  std::int64_t completed_ps(int master) const { return at(master).completed * clocks_.period_ps(); }
  // The time at which the present request will be done if no other one comes; kNever without a
  // request.
  std::int64_t forecast(int master) const;
  // The earliest of all forecasts, for which a user of the bus waits.
  std::int64_t next_completion() const;

  const Statistics& statistics(int master) const { return at(master).statistics; }
  const PciClocks& clocks() const { return clocks_; }

 private:
  struct Master {
    bool busy = false;
    bool releasing = false;  // its last data phase is over, the turnaround is not
    Direction direction = Direction::write;
    std::int64_t left = 0;   // data phases
    std::int64_t moved = 0;  // data phases
    std::int64_t bytes = 0;
    std::int64_t requested = 0;  // clock at which REQ# is asserted
    bool fetching = false;       // a target works on the delayed read of this burst
    bool fetched = false;        // …and has had it
    std::int64_t ready = 0;      // clock at which it has the data
    std::int64_t completed = 0;
    Statistics statistics;
  };

  const Master& at(int master) const { return masters_[static_cast<std::size_t>(master)]; }
  Master& at(int master) { return masters_[static_cast<std::size_t>(master)]; }
  bool competes(int master) const { return at(master).busy && !at(master).releasing; }
  std::int64_t clock_of(std::int64_t time_ps) const;
  void run(std::int64_t to);
  std::int64_t next_grant() const;
  PciArbiter followed(std::int64_t until_ps) const;
  std::int64_t owned_before(int master, std::int64_t until_ps) const;
  int winner(std::int64_t clock) const;
  void begin_tenure(std::int64_t clock);
  bool attempt_in_vain(const Master& m, std::int64_t clock) const;
  std::int64_t preempted_at() const;
  std::int64_t tenure_phases() const;
  std::int64_t tenure_end(std::int64_t phases) const;
  void end_tenure(std::int64_t phases);
  void release(std::int64_t clock);
  void report(int master, std::int64_t start, std::int64_t end) const;

  PciClocks clocks_;
  int count_;
  std::array<Master, kMaxMasters> masters_{};
  int owner_ = -1;
  int last_owner_ = -1;
  int last_user_ = -1;        // the last owner or, later, who held
  bool retrying_ = false;     // the tenure ends in a retry
  std::int64_t address_ = 0;  // clock of the tenure's address phase
  std::int64_t planned_ = 0;  // its data phases if nothing cuts it
  std::int64_t free_ = 0;     // clock from which the bus is idle
  std::int64_t held_ = 0;     // clocks
  Observer* observer_ = nullptr;
};

}  // namespace hvp::link
