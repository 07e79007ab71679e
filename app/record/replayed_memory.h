#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "app/record/record.h"

namespace hvp::record {

// Memory of a given size that costs nothing where nobody writes to it; zero at first.
class BlankMemory {
 public:
  // Throws std::invalid_argument where there is no room for it.
  explicit BlankMemory(std::uint64_t bytes);
  ~BlankMemory();
  BlankMemory(const BlankMemory&) = delete;
  BlankMemory& operator=(const BlankMemory&) = delete;

  std::span<std::uint8_t> bytes() const { return bytes_; }

 private:
  std::span<std::uint8_t> bytes_;
};

// The recorded host's memory, as far as its board has read it: when the board of the replay is
// about to read, the recorded words are put there. A read that the record has next, or soon, gets
// its words. Of any other each byte is that of the next recorded read that has it, else what the
// replay has left there.
class ReplayedMemory {
 public:
  // Keeps a reference.
  explicit ReplayedMemory(const Record& recorded);

  // A range as the host has mapped it. Throws std::invalid_argument as BlankMemory does, and for a
  // range at the place of another one.
  std::span<std::uint8_t> add(std::uint64_t address, std::uint64_t bytes);
  // Drops the ranges inside.
  void forget(std::uint64_t address, std::uint64_t bytes);
  // Puts there what is to be read. Addresses without memory stay so.
  void prepare(std::uint64_t address, std::size_t bytes);

 private:
  // What the read has of these bytes.
  void put(const Entry& read, std::uint64_t address, std::size_t bytes);

  std::vector<const Entry*> reads_;  // those that were answered
  std::size_t next_ = 0;             // of reads_
  std::map<std::uint64_t, BlankMemory> ranges_;
};

}  // namespace hvp::record
