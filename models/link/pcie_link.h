#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "models/link/direction.h"
#include "models/link/pcie.h"

namespace hvp::link {

// A PCI Express link packet by packet: every TLP waits for the wire, for credits and, if it is a
// read, for a tag. Ack, UpdateFC and SKIP go between them, and completions come back split. It has
// no clock of its own and is driven as PciArbiter is:
//
//   link.request(initiator, Direction::read, 4096, now);
//   …wait until link.forecast(initiator), or until somebody else requests…
//   link.advance(now);  link.done(initiator)
//
// Rules. Each direction sends one packet after the other; of the ready packets it takes those of
// the initiators and the completions in turn, whatever the order of the calls. Packets arrive in
// the order in which they were sent. Completions of one direction are in the order of their
// requests. Credits for completions are infinite, as root ports and endpoints advertise (PCIe 5.0
// §2.6.1).
//
// Nothing allocates after construction: a forecast runs in a second state that the constructor
// makes.
class PcieLink {
 public:
  static constexpr int kMaxInitiators = 8;

  struct Traffic {
    std::int64_t packets = 0;
    std::int64_t packet_bytes = 0;      // TLPs, framing included
    std::int64_t link_layer_bytes = 0;  // Ack, UpdateFC and SKIP
    std::int64_t busy_ps = 0;
  };

  // Gets every packet that was sent, with the link layer's packets before it; a completion counts
  // to its reader. Calls are in the order of time of each direction. Forecasts do not call it.
  class Observer {
   public:
    virtual ~Observer() = default;
    virtual void sent(PcieSide sender, int initiator, std::int64_t start_ps,
                      std::int64_t end_ps) = 0;
  };

  // `initiators` has one entry for each: the processor is at the root, a device's DMA channels at
  // the device. Throws InputError for none or more than kMaxInitiators, and as Pcie::check() does.
  PcieLink(const Pcie& link, std::span<const PcieSide> initiators);

  void report_to(Observer& observer) { observer_ = &observer; }

  // The initiator has no request under way but writes that have been sent, bytes > 0, and `time_ps`
  // is not before the last advance(). `times`, for a read, has to exist until its last completion
  // is back; without it every request takes Pcie::completer_ps().
  void request(int initiator, Direction direction, std::int64_t bytes, std::int64_t time_ps,
               const CompleterTimes* times = nullptr);
  // Requests a message, a posted packet without data, as a write is requested.
  void message(int initiator, std::int64_t time_ps);
  // Brings the link forward to this time.
  void advance(std::int64_t time_ps);
  bool busy(int initiator) const { return !done(initiator); }
  // True if a write's last byte is at the other side, or a read's is back, by the last advance().
  bool done(int initiator) const { return now_ >= completed_ps(initiator); }
  // The time at which the last request is done; kNever while it is not known.
  std::int64_t completed_ps(int initiator) const { return of(state_, initiator).completed; }
  // The time at which the last packet of the last request left its sender, so that the sender of a
  // posted write may go on; kNever while it is not known.
  std::int64_t sent_ps(int initiator) const { return of(state_, initiator).sent; }
  // The time at which the request will be done if no other one comes.
  std::int64_t forecast(int initiator) const;
  // The time at which its last packet will leave, likewise.
  std::int64_t forecast_sent(int initiator) const;

  const Traffic& traffic(PcieSide sender) const { return state_.wires[index(sender)].traffic; }

 private:
  struct Initiator {
    PcieSide side = PcieSide::root;
    Direction direction = Direction::write;
    bool message = false;
    std::int64_t requested = 0;
    std::int64_t to_send = 0;  // bytes not yet in a packet
    std::int64_t answers = 0;  // requests without their last completion
    std::int64_t issued = 0;   // read requests sent so far
    std::int64_t first = 0;    // the number of the present read's first request
    const CompleterTimes* times = nullptr;
    std::int64_t answered = 0;
    std::int64_t sent = 0;
    std::int64_t completed = 0;
  };
  struct Credit {
    std::int64_t returned = 0;  // the time at which it may be used again
    std::int64_t units = 0;
  };
  // Credits in use, the oldest first.
  struct Ring {
    std::vector<Credit> entries;
    std::size_t first = 0;
    std::size_t count = 0;
    std::int64_t units = 0;
  };
  struct Completion {
    int initiator = 0;
    std::int64_t bytes = 0;
    std::int64_t ready = 0;
  };
  struct WireState {
    std::int64_t free = 0;
    std::int64_t fraction = 0;  // fraction of a picosecond, in units of the byte time's denominator
    std::int64_t position = 0;  // bytes sent
    std::int64_t next_ack = 0;
    std::int64_t next_credit = 0;
    std::int64_t next_skip = 0;
    std::int64_t flit_fill = 0;
    int last_slot = 0;
    std::size_t first = 0;  // completion
    std::size_t count = 0;
    Traffic traffic;
  };
  struct Wire : WireState {
    Ring posted;
    Ring nonposted;
    std::vector<Completion> completions;
  };
  struct State {
    std::array<Wire, 2> wires;
    std::vector<Initiator> initiators;
    std::vector<std::int64_t> tags;  // the time of each tag's last release; initiator by initiator
  };
  struct Start {
    std::int64_t time = kNever;
    int slot = -1;  // an initiator, or the completions
  };
  struct Sent {
    std::int64_t end = 0;
    std::int64_t arrival = 0;
  };

  static std::size_t index(PcieSide side) { return side == PcieSide::root ? 0 : 1; }
  static const Initiator& of(const State& s, int i) {
    return s.initiators[static_cast<std::size_t>(i)];
  }
  static Initiator& of(State& s, int i) { return s.initiators[static_cast<std::size_t>(i)]; }
  int completion_slot() const { return static_cast<int>(state_.initiators.size()); }
  std::int64_t& tag(State& s, int initiator, std::int64_t number) const;
  std::int64_t tag(const State& s, int initiator, std::int64_t number) const;

  // The earliest time at which `units` more of `capacity` credits are free.
  static std::int64_t credit(const Ring& ring, std::int64_t units, std::int64_t capacity);
  static void take(Ring& ring, std::int64_t now, Credit credit);
  // Copies the present state to `ahead_`; of the rings and completions only the entries in use,
  // which are few.
  void look_ahead() const;

  std::int64_t ready(const State& s, std::size_t wire, int slot) const;
  Start next(const State& s, std::size_t wire) const;
  bool step(State& s, std::int64_t before) const;
  Sent send(Wire& wire, std::int64_t start, std::int64_t bytes) const;
  void send_write(State& s, std::size_t wire, int initiator, std::int64_t start) const;
  void send_request(State& s, std::size_t wire, int initiator, std::int64_t start) const;
  void send_completion(State& s, std::size_t wire, std::int64_t start) const;

  Pcie link_;
  ByteTime byte_;
  std::int64_t dllp_interval_;
  std::int64_t now_ = 0;
  State state_;
  mutable State ahead_;
  Observer* observer_ = nullptr;
};

}  // namespace hvp::link
