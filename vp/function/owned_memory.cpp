#include "vp/function/owned_memory.h"

#include <algorithm>

#include "vp/fpga/dma_engine.h"
#include "vp/fpga/register_bank.h"
#include "vp/function/access_words.h"

namespace hvp::vp {

namespace {

std::size_t size_of(Aperture aperture) {
  return kApertures[static_cast<std::size_t>(aperture)].size;
}

}  // namespace

void OwnedMemory::begin() {
  give_back();
  contents_.clear();
}

void OwnedMemory::take_job(const HostMemory& memory, const List& list, std::uint64_t record) {
  begin();
  // The record's write ends the list, so that it has to be known.
  if (!own(memory, "the record", record, 4 * kRecordWords)) return;
  own_list(memory, list, "the list", "b", size_of(Aperture::b));
}

void OwnedMemory::take_values(const HostMemory& memory, const List& list) {
  begin();
  is_values_ = true;
  own_list(memory, list, "the list of values", "the values", size_of(Aperture::value));
}

// Descriptors that bring more than the board can hold are not followed further: it will refuse
// them.
void OwnedMemory::own_list(const HostMemory& memory, const List& list, const char* name,
                           const char* what, std::size_t most_bytes) {
  const std::size_t count = std::size_t{list.to_board} + list.to_host;
  if (!own(memory, name, list.address, count * kDescriptorBytes)) return;
  const std::size_t first = parts_.back().at;
  std::size_t left = most_bytes;
  for (std::size_t i = 0; i < list.to_board; ++i) {
    const std::span<const std::uint8_t> one =
        std::span(contents_).subspan(first + i * kDescriptorBytes, kDescriptorBytes);
    const std::uint32_t bytes = word_at(one, 4);
    if (bytes > left) return;
    left -= bytes;
    own(memory, what, address_of(word_at(one, 8), word_at(one, 12)), bytes);
  }
}

bool OwnedMemory::own(const HostMemory& memory, const char* what, std::uint64_t address,
                      std::size_t bytes) {
  if (bytes == 0) return false;
  const std::size_t at = contents_.size();
  contents_.resize(at + bytes);
  if (!memory.copy(address, std::span(contents_).subspan(at))) {
    contents_.resize(at);
    return false;
  }
  parts_.push_back({what, address, at, bytes});
  return true;
}

std::optional<OwnedMemory::Part> OwnedMemory::changed(const HostMemory& memory, bool read,
                                                      std::uint64_t address, std::size_t bytes) {
  std::optional<Part> found;
  for (const Part& part : parts_) {
    if (!overlap(address, bytes, part.address, part.bytes)) continue;
    const std::uint64_t first = std::max(address, part.address);
    const std::uint64_t end = std::min(address + bytes, part.address + part.bytes);
    present_.resize(end - first);
    if (!memory.copy(first, present_)) continue;
    const auto before = std::span(contents_).subspan(part.at + (first - part.address), end - first);
    if (std::ranges::equal(before, present_)) continue;
    if (!found) found = part;
    std::ranges::copy(present_, before.begin());
  }
  // The record ends the list; it may arrive in parts.
  const bool ends = !read && !is_values_ && !parts_.empty() &&
                    overlap(address, bytes, parts_.front().address, parts_.front().bytes);
  if (ends) give_back();
  return found;
}

std::optional<OwnedMemory::Part> OwnedMemory::part_in(std::uint64_t address,
                                                      std::uint64_t bytes) const {
  const auto part = std::ranges::find_if(
      parts_, [&](const Part& one) { return overlap(address, bytes, one.address, one.bytes); });
  if (part == parts_.end()) return std::nullopt;
  return *part;
}

}  // namespace hvp::vp
