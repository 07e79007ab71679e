#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "models/random/draws.h"
#include "vp/fault/fault.h"
#include "vp/frame/frame.h"

namespace hvp::vp {

// What came of one item of [[fault]].
struct FaultRecord {
  Fault fault;
  std::int64_t injected = 0;
  std::int64_t noticed = 0;    // by the driver, whatever it did then
  std::int64_t corrected = 0;  // by the bus itself, at the cost of time
  std::int64_t first_frame = -1;

  std::int64_t unnoticed() const { return injected - noticed - corrected; }
};

// Says which fault happens in which frame, and keeps what came of it. A draw is a function of the
// seed, the kind, the frame and which item of the kind it is for; nothing that happened before
// changes it. The parts of the board and the bus ask here where the thing would happen.
class FaultPlan {
 public:
  FaultPlan(const std::vector<Fault>& faults, std::int64_t seed, Picoseconds period);

  // Whether a fault of this kind happens here; then it is injected, once a frame an item.
  const Fault* strike(FaultKind kind, std::int64_t frame, FaultAccess access = FaultAccess::first);
  // Which word of a block and which of its bits, for a fault that struck this frame.
  std::uint32_t word(const Fault& fault, std::int64_t frame, std::uint32_t words) const;
  std::uint32_t mask(const Fault& fault, std::int64_t frame) const;

  // When the servo loop begins: frame n is then born at begin + n·T.
  void begin(Picoseconds begin) { begin_ = begin; }
  // Whether the board is gone when an access or an interrupt of this frame happens, −1 for set-up
  // and recovery.
  bool gone(Picoseconds now, std::int64_t frame);
  // Whether it has come back since the last call: it then is as after power-on.
  bool take_return() { return std::exchange(returned_, false); }

  // The driver ended this frame with an error, and nothing of the frame was used.
  void notice_failure(std::int64_t frame);
  // A single thing that it saw, and went on.
  void notice(FaultKind kind, std::int64_t frame);
  // The bus repaired the fault that struck last.
  void correct(const Fault& fault);

  const std::vector<FaultRecord>& records() const { return records_; }
  std::int64_t injected() const;
  std::int64_t unnoticed() const;

 private:
  static constexpr Picoseconds kNever = std::numeric_limits<Picoseconds>::max();

  // Strikes that are not noticed yet; two frames are in flight at most.
  struct Item {
    std::uint32_t number = 0;  // among those of its kind
    std::int64_t struck = -1;
    std::array<std::int64_t, 2> open{-1, -1};
  };

  bool due(std::size_t item, std::int64_t frame) const;
  void inject(std::size_t item, std::int64_t frame);
  void notice_item(std::size_t item, std::int64_t frame);
  bool leaves(std::size_t item, Picoseconds now, std::int64_t frame) const;
  void leave(std::size_t item, std::int64_t frame);
  std::size_t item_of(const Fault& fault) const;

  Picoseconds period_;
  Picoseconds begin_ = -1;
  std::array<random::Draws, kFaultKinds> draws_;
  std::vector<FaultRecord> records_;
  std::vector<Item> items_;
  bool gone_ = false;
  Picoseconds back_at_ = kNever;
  bool returned_ = false;
};

}  // namespace hvp::vp
