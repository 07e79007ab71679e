#include "app/record/replayed_memory.h"

#include <algorithm>
#include <stdexcept>

#include <sys/mman.h>

namespace hvp::record {

namespace {

// How many recorded reads ahead a read is looked for that is not the next one.
constexpr std::size_t kLookAhead = 4096;

// True if [inner, inner + inner_bytes) is all in the other range.
bool inside(std::uint64_t inner, std::uint64_t inner_bytes, std::uint64_t outer,
            std::uint64_t outer_bytes) {
  return inner >= outer && inner - outer < outer_bytes &&
         inner_bytes <= outer_bytes - (inner - outer);
}

}  // namespace

BlankMemory::BlankMemory(std::uint64_t bytes) {
  if (bytes == 0) throw std::invalid_argument("a range of memory without a byte");
  void* const place = mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                           MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (place == MAP_FAILED) throw std::invalid_argument("there is not so much memory");
  bytes_ = {static_cast<std::uint8_t*>(place), bytes};
}

BlankMemory::~BlankMemory() { munmap(bytes_.data(), bytes_.size()); }

ReplayedMemory::ReplayedMemory(const Record& recorded) {
  for (const Entry& entry : recorded.entries()) {
    if (entry.kind == Kind::memory_read && entry.has(kAnswered)) reads_.push_back(&entry);
  }
}

std::span<std::uint8_t> ReplayedMemory::add(std::uint64_t address, std::uint64_t bytes) {
  const auto [range, added] = ranges_.try_emplace(address, bytes);
  if (!added) throw std::invalid_argument("a range of memory overlaps another one");
  return range->second.bytes();
}

void ReplayedMemory::forget(std::uint64_t address, std::uint64_t bytes) {
  std::erase_if(ranges_, [=](const auto& range) {
    return inside(range.first, range.second.bytes().size(), address, bytes);
  });
}

void ReplayedMemory::prepare(std::uint64_t address, std::size_t bytes) {
  const auto begin = reads_.begin() + static_cast<std::ptrdiff_t>(next_);
  const auto end = begin + static_cast<std::ptrdiff_t>(std::min(kLookAhead, reads_.size() - next_));
  const auto same = std::find_if(begin, end, [=](const Entry* read) {
    return read->address == address && read->bytes == bytes;
  });
  if (same != end) {
    put(**same, address, bytes);
    next_ = static_cast<std::size_t>(same - reads_.begin()) + 1;
    return;
  }
  // The nearest read is put last and stays.
  for (auto read = end; read != begin; --read) put(**(read - 1), address, bytes);
  while (next_ < reads_.size() &&
         inside(reads_[next_]->address, reads_[next_]->bytes, address, bytes)) {
    ++next_;
  }
}

// A read may cross from one range to the next.
void ReplayedMemory::put(const Entry& read, std::uint64_t address, std::size_t bytes) {
  for (const auto& [begin, range] : ranges_) {
    const std::uint64_t from = std::max({begin, read.address, address});
    const std::uint64_t to =
        std::min({begin + range.bytes().size(), read.address + read.data.size(), address + bytes});
    if (from >= to) continue;
    std::ranges::copy(read.data.subspan(from - read.address, to - from),
                      range.bytes().begin() + static_cast<std::ptrdiff_t>(from - begin));
  }
}

}  // namespace hvp::record
