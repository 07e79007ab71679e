#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/config/declaration.h"
#include "models/random/draws.h"
#include "vp/fpga/engine/flip.h"
#include "vp/frame/frame.h"

namespace hvp::vp {

enum class FaultKind {
  lost_interrupt,        // the board's interrupt does not reach the host
  stuck_busy,            // the job does not end; STATUS.busy stays until a reset
  saturated_solve,       // the job's b is at the limits of its words
  master_abort,          // no target claims one access
  device_gone,           // no target claims any access, and no interrupt comes
  corrupted_word,        // bits of one word of a block are flipped on the bus
  late_dma,              // U leaves the board late
  truncated_dma,         // the last bytes of U stay on the board
  surprise_removal,      // from an access on the function is not there any more, for good
  function_level_reset,  // somebody else resets the function while the job runs
  aer_correctable,       // a packet to the board has a wrong CRC and comes again
  aer_uncorrectable,     // a write arrives poisoned, and the board drops it
  flip,                  // a bit of the engine's memories or registers changes
};
inline constexpr int kFaultKinds = 13;

const char* name(FaultKind kind);

// The access of a frame to the solver board that a fault hits.
enum class FaultAccess { first, rhs, start, status, acknowledge, solution, values };

const char* name(FaultAccess access);

// A fault and its time: one item of the scenario's list [[fault]].
struct Fault {
  FaultKind kind = FaultKind::lost_interrupt;
  std::int64_t frame = -1;  // −1: not stated
  std::int64_t count = 1;   // frames in a row, from `frame` on
  double rate = 0;          // 0: not stated
  FaultAccess access = FaultAccess::first;
  int bits = 0;
  std::int64_t frames = 0;
  double delay_s = 0;
  int bytes = 0;
  engine::Flip flip{};
  std::int64_t clock = -1;  // from the job's start on; −1: any of a solve

  void declare(config::Visitor& v);
  // Throws InputError unless exactly one of frame and rate is stated.
  void check() const;
  // True if neither is: a fault that was asked for during the run, and strikes where it can next.
  bool comes_next() const { return frame < 0 && !(rate > 0); }
  // Throws InputError as check() does, for one that may come next.
  void check_injected() const;

  std::int64_t delay_ps() const;
  // The number of flipped bits in a corrupted word.
  int flipped_bits() const { return bits == 0 ? 1 : bits; }

 private:
  void declare_flip(config::Visitor& v);
};

// The error bits of the bridge's status register, which stay until they are cleared (PCI 3.0
// §6.2.3): received master abort (bit 13), and master data parity error (bit 8), which its own
// check of a read or the target's PERR# after a write sets.
struct BusErrors {
  bool master_abort = false;
  bool parity = false;
};

// What flips have done to the board's solutions, beside an engine that they have not struck and
// that begins each job with the same U and b. A job counts for the newest flip.
struct FlipEffect {
  std::int64_t wrong = 0;  // jobs with other words of U
  std::int64_t last_wrong_frame = -1;
  double worst = 0;       // of these the largest |error| over the largest |U|
  std::int64_t told = 0;  // of these jobs those whose flags tell of it
  engine::Flip flip;      // the first one, with all that was chosen
  std::int64_t clock = -1;
  std::int64_t flipped = 0;  // of those injected; the others lie behind the end of the run
  std::string lacking;       // why the engine has no such bit: "node is 48, expected less than 48"
};

// The outcome of one item of [[fault]].
struct FaultRecord {
  Fault fault;
  FlipEffect effect;
  std::int64_t injected = 0;
  std::int64_t noticed = 0;    // by the driver, whatever followed
  std::int64_t corrected = 0;  // by the bus itself, at the cost of time
  std::int64_t first_frame = -1;
  std::int64_t asked_after = 0;  // the frames that had begun when it was asked for

  std::int64_t unnoticed() const { return injected - noticed - corrected; }
  // The number of frames in which it was to happen and did not; of a rate, 1 if it never did.
  std::int64_t missing() const;
  // Why it did not happen in a run of so many frames, in words; empty if it did.
  std::string why_not(std::int64_t frames) const;
};

// Decides which fault happens in which frame, and records the outcome. A draw is a function of the
// seed, the kind, the frame and the item's number among those of its kind, and of nothing that
// happened before. The parts of the board and the bus call it at the place of the fault.
class FaultPlan {
 public:
  FaultPlan(const std::vector<Fault>& faults, std::int64_t seed, Picoseconds period);

  // Adds a fault during the run, after so many frames have begun.
  void add(const Fault& fault, std::int64_t frames = 0);

  // Returns the fault of this kind that happens here and counts it as injected, at most once for
  // each item and frame; null: none.
  const Fault* strike(FaultKind kind, std::int64_t frame, FaultAccess access = FaultAccess::first);
  // The word of a block and its bits that the fault flips in this frame.
  std::uint32_t word(const Fault& fault, std::int64_t frame, std::uint32_t words) const;
  std::uint32_t mask(const Fault& fault, std::int64_t frame) const;
  // One of `range` values for the index of a flip that this frame's has not stated; the clock has
  // the number 0.
  std::int64_t choose(const Fault& fault, std::int64_t frame, std::uint32_t number,
                      std::int64_t range) const;
  // The fault that struck last cannot happen: it is not counted.
  void retract(const Fault& fault);
  FlipEffect& effect(const Fault& fault) { return records_[item_of(fault)].effect; }

  // The servo loop begins at `begin`, and frame n is born at begin + n·T.
  void begin(Picoseconds begin) { begin_ = begin; }
  // The birth of a frame of a host that keeps no such time.
  void born(std::int64_t frame, Picoseconds time) { newest_ = {frame, time}; }
  // True if the board is gone at an access or an interrupt of this frame; −1 for set-up and
  // recovery.
  bool gone(Picoseconds now, std::int64_t frame);
  // The function was pulled out now: it is gone for good, its configuration space too.
  void remove();
  bool removed() const { return removed_; }
  // Who is told when one of the kinds aer_correctable and aer_uncorrectable strikes.
  void on_packet_error(std::function<void(FaultKind)> told) { packet_error_ = std::move(told); }
  void tell_of_packet_error(FaultKind kind) const {
    if (packet_error_) packet_error_(kind);
  }
  // True if the board has come back since the last call, in its state after power-on.
  bool take_return() { return std::exchange(returned_, false); }

  // The driver ended this frame with an error, and the frame's results were not used.
  void notice_failure(std::int64_t frame);
  // The driver noticed a fault of this kind and continued.
  void notice(FaultKind kind, std::int64_t frame);
  // The bus repaired the fault that struck last.
  void correct(const Fault& fault);

  const std::deque<FaultRecord>& records() const { return records_; }
  std::int64_t injected() const;
  std::int64_t unnoticed() const;

 private:
  static constexpr Picoseconds kNever = std::numeric_limits<Picoseconds>::max();

  // The state of an item. Two frames are in flight at most.
  struct Item {
    std::uint32_t number = 0;  // among the items of its kind
    std::int64_t struck = -1;
    std::array<std::int64_t, 2> open{-1, -1};
    std::int64_t absent_since = -1;  // the first frame without the board that nobody has noticed
  };

  bool due(std::size_t item, std::int64_t frame) const;
  void inject(std::size_t item, std::int64_t frame);
  void notice_item(std::size_t item, std::int64_t frame);
  // The frame in which the item takes the board away now; none: it does not.
  std::optional<std::int64_t> leaves(std::size_t item, Picoseconds now, std::int64_t frame) const;
  Picoseconds birth_of(std::int64_t frame) const;
  void leave(std::size_t item, std::int64_t frame);
  std::size_t item_of(const Fault& fault) const;

  Picoseconds period_;
  Picoseconds begin_ = -1;
  struct Birth {
    std::int64_t frame = -1;
    Picoseconds time = 0;
  };
  Birth newest_;
  std::array<random::Draws, kFaultKinds> draws_;
  std::deque<FaultRecord> records_;  // those who strike keep a reference to the fault
  std::vector<Item> items_;
  bool gone_ = false;
  bool removed_ = false;
  std::function<void(FaultKind)> packet_error_;
  Picoseconds back_at_ = kNever;
  bool returned_ = false;
};

}  // namespace hvp::vp
