#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "vp/fpga/register_bank.h"
#include "vp/frame/frame.h"

namespace hvp::guest {

// The last accesses of a host to the board's BAR, for the day on which it hangs: what it asked
// last, and what it never got an answer to. A ring; nothing is allocated for an access.
class RecentAccesses {
 public:
  static constexpr std::size_t kKept = 10;

  // Notes an access that is about to be made, and returns its number, for ended().
  std::uint64_t begin(vp::Picoseconds time, vp::Command command, std::uint64_t offset,
                      std::span<const std::uint8_t> data);
  // Its end; `data` is what was read or written.
  void end(std::uint64_t number, vp::Picoseconds time, std::span<const std::uint8_t> data);

  // When the last job was started, and which of the run's it is, from 1; none: no job was.
  struct Job {
    std::int64_t number;
    vp::Picoseconds started;
  };
  const std::optional<Job>& job() const { return job_; }

  // A line for each, the oldest first: when, which register, and the first word.
  std::string text(const vp::RegisterBank& bank) const;

 private:
  struct Access {
    vp::Picoseconds began = 0;
    vp::Picoseconds ended = -1;  // not yet
    vp::Command command = vp::Command::read;
    std::uint64_t offset = 0;
    std::size_t bytes = 0;
    std::uint32_t word = 0;
  };

  std::array<Access, kKept> accesses_{};
  std::uint64_t made_ = 0;
  std::optional<Job> job_;
};

}  // namespace hvp::guest
