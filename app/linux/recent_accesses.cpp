#include "app/linux/recent_accesses.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/results/number_text.h"
#include "vp/function/job_frames.h"

namespace hvp::guest {

namespace {

// Of bytes as they travel, little-endian.
std::uint32_t first_word(std::span<const std::uint8_t> data) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(4, data.size()); ++i) {
    word |= std::uint32_t{data[i]} << (8 * i);
  }
  return word;
}

}  // namespace

std::uint64_t RecentAccesses::begin(vp::Picoseconds time, vp::Command command, std::uint64_t offset,
                                    std::span<const std::uint8_t> data) {
  if (vp::step_of(command, offset, data) == vp::Step::start) {
    job_ = Job{job_ ? job_->number + 1 : 1, time};
  }
  accesses_[made_ % kKept] = {time, -1, command, offset, data.size(), first_word(data)};
  return made_++;
}

void RecentAccesses::end(std::uint64_t number, vp::Picoseconds time,
                         std::span<const std::uint8_t> data) {
  if (number + kKept < made_) return;  // overwritten meanwhile
  Access& access = accesses_[number % kKept];
  access.ended = time;
  access.word = first_word(data);
}

std::string RecentAccesses::text(const vp::RegisterBank& bank) const {
  std::string text;
  for (std::uint64_t k = made_ > kKept ? made_ - kKept : 0; k < made_; ++k) {
    const Access& access = accesses_[k % kKept];
    const bool reads = access.command == vp::Command::read;
    const bool answered = access.ended >= 0;
    text += fmt::format("\n    {} us  {} {}", results::microseconds(access.began),
                        reads ? "read" : "write", bank.name_at(access.offset));
    if (!reads || answered) text += fmt::format(" 0x{:08x}", access.word);
    if (access.bytes != sizeof access.word) text += fmt::format(", of {} bytes", access.bytes);
    if (!answered) text += ", under way";
  }
  return text.empty() ? "\n    none" : text;
}

}  // namespace hvp::guest
