#include "vp/function/message_table.h"

#include <algorithm>

namespace hvp::vp {

namespace {

constexpr std::uint64_t kWord = 4;
// The bits of each word of an entry that software may write.
constexpr std::array<std::uint32_t, 4> kWritable = {0xffff'fffc, 0xffff'ffff, 0xffff'ffff, 1};

bool whole_words(std::uint64_t offset, std::size_t bytes) {
  return (bytes == kWord || bytes == 2 * kWord) && offset % bytes == 0;
}

}  // namespace

std::uint32_t MessageTable::word(std::uint64_t offset) const {
  if (offset < kWord * entry_.size()) return entry_.at(offset / kWord);
  return offset == kPendingAt && pending_ ? 1 : 0;
}

void MessageTable::read(std::uint64_t offset, std::span<std::uint8_t> data) const {
  // Nobody answers what is no word of it.
  if (!whole_words(offset, data.size()) || offset >= kBytes) {
    std::ranges::fill(data, std::uint8_t{0xff});
    return;
  }
  for (std::size_t i = 0; i < data.size(); ++i) {
    const std::uint32_t from = word(offset + i / kWord * kWord);
    data[i] = static_cast<std::uint8_t>(from >> 8 * (i % kWord));
  }
}

void MessageTable::write(std::uint64_t offset, std::span<const std::uint8_t> data) {
  if (!whole_words(offset, data.size())) return;
  for (std::size_t i = 0; i < data.size(); i += kWord) {
    const std::uint64_t index = (offset + i) / kWord;
    if (index >= entry_.size()) return;
    std::uint32_t given = 0;
    for (std::size_t byte = 0; byte < kWord; ++byte) {
      given |= static_cast<std::uint32_t>(data[i + byte]) << 8 * byte;
    }
    entry_.at(index) = given & kWritable.at(index);
  }
}

}  // namespace hvp::vp
