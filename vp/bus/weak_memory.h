#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "models/config/figures.h"
#include "models/random/draws.h"

namespace hvp::vp {

class HostMemory;

// The host's memory behind a processor that makes its stores visible late and in any order (Linux'
// Documentation/memory-barriers.txt, "CPU memory barriers" and "DMA"): what was stored before the
// last barrier is visible to the board, and of what was stored since, a line at a time is or is
// not. An access to a register is no barrier, as writel_relaxed() is none; a driver that is right
// behind this is right behind every processor.
//
// A store that is not visible when the board writes to the same place may reach memory behind the
// board's words, which are lost then.
//
// The order of the host's loads is not among it: a read that is too early, such as of U before the
// record, is not brought about.
class WeakMemory {
 public:
  static constexpr std::size_t kLineBytes = 64;  // of a cache: x86 and most of ARM

  struct Counts {
    std::int64_t barriers = 0;
    std::int64_t transfers = 0;  // accesses of the board's to memory
    std::int64_t unordered = 0;  // accesses of the board's to what had no barrier
    std::int64_t changed = 0;    // of these, those that got old words or whose words were lost
    void report(config::Figures& f) const;
  };

  // Keeps a reference.
  WeakMemory(const HostMemory& memory, std::int64_t seed);

  // The driver has made this memory the board's to reach, and what it holds now is visible. A range
  // that is not all in the host's memory is none.
  void map(std::uint64_t address, std::uint64_t bytes);
  // Forgets the newest mapping with this address.
  void unmap(std::uint64_t address);
  // And those that lie in this range.
  void unmap_all(std::uint64_t address, std::uint64_t bytes);
  // What was stored until now is visible: all of it, or in this range.
  void barrier();
  void sync(std::uint64_t address, std::uint64_t bytes);

  // The board reads: `data` has what memory holds, and is given what the board sees. Returns true
  // if something in it had no barrier.
  bool read(std::uint64_t address, std::span<std::uint8_t> data);
  // The board writes: `data` is what it writes, and is given what memory holds behind it. Returns
  // true if the host had stored there without a barrier.
  bool write(std::uint64_t address, std::span<std::uint8_t> data);

  const Counts& counts() const { return counts_; }

 private:
  struct Range {
    std::uint64_t address = 0;
    std::vector<std::uint8_t> visible;
  };

  // Calls visit(range, first byte in it, first byte of the access, bytes) for each line of each
  // range that the access has a part of.
  template <class Visit>
  void each_line(std::uint64_t address, std::size_t bytes, const Visit& visit);
  bool heads();

  const HostMemory& memory_;
  random::Draws draws_;
  std::int64_t drawn_ = 0;
  std::vector<Range> ranges_;  // by age
  std::vector<std::uint8_t> present_;
  Counts counts_;
};

}  // namespace hvp::vp
