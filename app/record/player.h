#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "app/record/record.h"
#include "app/record/recorder.h"
#include "app/record/replayed_memory.h"
#include "vp/function/outside_host.h"

namespace hvp::record {

// Makes the accesses of a record again, on the board of any scenario, and records what comes of
// them.
//
// An access is made at its recorded time, or later: once the accesses have ended and the interrupts
// have come that the recorded host had seen before it made the access. An interrupt is no longer
// awaited once the board has been idle for kSettle, after kLongest, or when nothing can happen any
// more; it is then missing.
class Player : private Recorder {
 public:
  static constexpr Picoseconds kSettle = 1'000'000'000;       // 1 ms
  static constexpr Picoseconds kLongest = 1'000'000'000'000;  // 1 s

  // Makes a fault happen that the recorded program has asked for; throws InputError.
  using Inject = std::function<void(std::string_view words)>;

  // Keeps references. The simulation has not begun. `file` is the record's, for errors.
  Player(vp::BoardFunction& function, const Record& recorded, std::string_view file, Inject inject);

  // Throws InputError where the record has the host map memory that is not possible, or ask for a
  // fault that is not possible on this board.
  Record play();

 private:
  void to_be_moved(bool read, std::uint64_t address, std::size_t bytes) override;
  void ask(const Entry& entry);
  void change_memory(const Entry& entry);
  void inject(const Entry& entry);
  void wait_for(Picoseconds time);
  bool waits() const;
  bool in_vain(Picoseconds since);
  void let_pass_what_is_due();
  bool busy();

  vp::BoardFunction& function_;
  const Record& recorded_;
  std::string file_;
  Inject inject_;
  std::string replayed_;
  ReplayedMemory memory_;
  std::deque<std::vector<std::uint8_t>> data_;  // of the accesses, in order
  std::uint64_t asked_ = 0;
  std::uint64_t ends_awaited_ = 0;
  std::uint64_t interrupts_awaited_ = 0;
  std::uint64_t missing_ = 0;
  Picoseconds last_busy_ = 0;
  bool hangs_ = false;  // an access does not end
};

}  // namespace hvp::record
