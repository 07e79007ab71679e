#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "vp/bus/host_memory.h"

namespace hvp::vp {

// True if [a, a + a_bytes) has a part of the other range.
constexpr bool overlap(std::uint64_t a, std::uint64_t a_bytes, std::uint64_t b,
                       std::uint64_t b_bytes) {
  return a < b ? b - a < a_bytes : a - b < b_bytes;
}

// Host memory that the board owns from a doorbell on, and what it held then: the lists, what their
// descriptors bring to the board, and a job's completion record.
class OwnedMemory {
 public:
  struct Part {
    const char* what = "";
    std::uint64_t address = 0;
    std::size_t at = 0;  // in the contents
    std::size_t bytes = 0;
  };
  // A list's registers as the host has posted them.
  struct List {
    std::uint64_t address = 0;
    std::uint32_t to_board = 0;  // descriptors, which come first
    std::uint32_t to_host = 0;
  };

  // A job's, until its record is written. Memory that is not mapped is no part: the board is
  // refused there.
  void take_job(const HostMemory& memory, const List& list, std::uint64_t record);
  // What brings VALUE, until the board has it.
  void take_values(const HostMemory& memory, const List& list);
  void give_back() {
    parts_.clear();
    is_values_ = false;
  }

  bool empty() const { return parts_.empty(); }
  // No record ends them.
  bool is_values() const { return is_values_; }
  // The first part that has changed since the doorbell where the board is about to move bytes;
  // the next call compares with what is there now. The write of a job's record gives all back.
  std::optional<Part> changed(const HostMemory& memory, bool read, std::uint64_t address,
                              std::size_t bytes);
  std::optional<Part> part_in(std::uint64_t address, std::uint64_t bytes) const;

 private:
  void begin();
  bool own(const HostMemory& memory, const char* what, std::uint64_t address, std::size_t bytes);
  void own_list(const HostMemory& memory, const List& list, const char* name, const char* what,
                std::size_t most_bytes);

  std::vector<Part> parts_;
  std::vector<std::uint8_t> contents_;
  std::vector<std::uint8_t> present_;
  bool is_values_ = false;
};

}  // namespace hvp::vp
