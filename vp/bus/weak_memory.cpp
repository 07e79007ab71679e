#include "vp/bus/weak_memory.h"

#include <algorithm>
#include <iterator>

#include "vp/bus/host_memory.h"

namespace hvp::vp {

void WeakMemory::Counts::report(config::Figures& f) const {
  f.count("barriers", barriers, "of the host's that the board has heard of");
  f.count("transfers", transfers, "accesses of the board's to memory");
  f.count(
      "unordered", unordered,
      "accesses of the board's to memory that the host had stored to without a barrier behind it");
  f.count("changed", changed, "of these, those that got old words, or whose own were lost");
}

WeakMemory::WeakMemory(const HostMemory& memory, std::int64_t seed)
    : memory_(memory), draws_(seed, "guest.memory_order") {}

void WeakMemory::map(std::uint64_t address, std::uint64_t bytes) {
  Range range{address, std::vector<std::uint8_t>(bytes)};
  if (memory_.copy(address, range.visible)) ranges_.push_back(std::move(range));
}

void WeakMemory::unmap(std::uint64_t address) {
  const auto newest = std::ranges::find(ranges_.rbegin(), ranges_.rend(), address, &Range::address);
  if (newest != ranges_.rend()) ranges_.erase(std::next(newest).base());
}

void WeakMemory::unmap_all(std::uint64_t address, std::uint64_t bytes) {
  std::erase_if(ranges_, [=](const Range& range) {
    return range.address >= address && range.address - address < bytes;
  });
}

void WeakMemory::barrier() {
  ++counts_.barriers;
  for (Range& range : ranges_) memory_.copy(range.address, range.visible);
}

void WeakMemory::sync(std::uint64_t address, std::uint64_t bytes) {
  each_line(address, bytes, [&](Range& range, std::size_t at, std::size_t, std::size_t length) {
    memory_.copy(range.address + at, std::span(range.visible).subspan(at, length));
  });
}

bool WeakMemory::read(std::uint64_t address, std::span<std::uint8_t> data) {
  bool unordered = false;
  bool changed = false;
  each_line(address, data.size(),
            [&](Range& range, std::size_t at, std::size_t from, std::size_t length) {
              const auto visible = std::span(range.visible).subspan(at, length);
              const auto present = data.subspan(from, length);
              if (std::ranges::equal(visible, present)) return;
              unordered = true;
              if (heads()) {
                std::ranges::copy(present, visible.begin());  // and remains so
              } else {
                std::ranges::copy(visible, present.begin());
                changed = true;
              }
            });
  ++counts_.transfers;
  counts_.unordered += unordered ? 1 : 0;
  counts_.changed += changed ? 1 : 0;
  return unordered;
}

bool WeakMemory::write(std::uint64_t address, std::span<std::uint8_t> data) {
  bool unordered = false;
  bool changed = false;
  each_line(address, data.size(),
            [&](Range& range, std::size_t at, std::size_t from, std::size_t length) {
              const auto visible = std::span(range.visible).subspan(at, length);
              const auto written = data.subspan(from, length);
              present_.resize(length);
              if (!memory_.copy(range.address + at, present_)) return;
              if (!std::ranges::equal(visible, present_)) {
                unordered = true;
                if (!heads()) {
                  changed = true;
                  for (std::size_t i = 0; i < length; ++i) {
                    if (visible[i] != present_[i]) written[i] = present_[i];
                  }
                }
              }
              std::ranges::copy(written, visible.begin());
            });
  ++counts_.transfers;
  counts_.unordered += unordered ? 1 : 0;
  counts_.changed += changed ? 1 : 0;
  return unordered;
}

template <class Visit>
void WeakMemory::each_line(std::uint64_t address, std::size_t bytes, const Visit& visit) {
  for (Range& range : ranges_) {
    const std::uint64_t end = range.address + range.visible.size();
    const std::uint64_t first = std::max(address, range.address);
    const std::uint64_t last = std::min(address + bytes, end);
    for (std::uint64_t at = first; at < last;) {
      const std::uint64_t next = std::min(last, (at / kLineBytes + 1) * kLineBytes);
      visit(range, at - range.address, at - address, next - at);
      at = next;
    }
  }
}

bool WeakMemory::heads() { return draws_.nth(drawn_++).first < 0.5; }

}  // namespace hvp::vp
