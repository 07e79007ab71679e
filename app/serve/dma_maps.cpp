#include "app/serve/dma_maps.h"

#include <iterator>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace hvp::serve {

namespace {

// The last address of a range; both have been checked.
std::uint64_t last_of(std::uint64_t address, std::uint64_t bytes) { return address + (bytes - 1); }

}  // namespace

DmaMaps::DmaMaps(FunctionPort& function) : function_(function) {
  function_.before_memory([this] { drop_cut_off(); });
}

DmaMaps::~DmaMaps() {
  clear();
  function_.before_memory({});
}

void DmaMaps::drop_cut_off() {
  for (auto& [address, range] : ranges_) {
    if (range.memory.empty() || range.memory.front().whole()) continue;
    spdlog::warn("memory at {:#x}, {} bytes, was cut off: the board cannot reach it", address,
                 range.bytes);
    function_.unmap(address, range.bytes);
    range.memory.clear();
  }
}

bool DmaMaps::overlaps(std::uint64_t address, std::uint64_t bytes) const {
  const auto behind = ranges_.upper_bound(last_of(address, bytes));
  if (behind == ranges_.begin()) return false;
  const auto& [at, range] = *std::prev(behind);
  return last_of(at, range.bytes) >= address;
}

void DmaMaps::map(const DmaMap& command, std::vector<FileDescriptor> files) {
  const auto [argsz, flags, offset, address, bytes] = command;
  if (argsz < sizeof command) throw Refused(EINVAL, "memory without a whole description");
  if (flags == 0 || (flags & ~(kReadable | kWritable)) != 0) {
    throw Refused(EINVAL, fmt::format("flags {:#x} of memory", flags));
  }
  if (bytes == 0 || last_of(address, bytes) < address) {
    throw Refused(EINVAL, fmt::format("memory of {} bytes at {:#x}", bytes, address));
  }
  if (files.size() > 1) throw Refused(EINVAL, "memory of more than one file");
  if (ranges_.size() >= kMostMaps) throw Refused(ENOSPC, "too many ranges of memory");
  if (overlaps(address, bytes)) throw Refused(EEXIST, "memory over other memory");
  Range range{bytes, {}};
  if (files.empty() && (flags & kWritable) == 0) {
    // A virtual machine's ROM, which no driver gives to the board.
    spdlog::debug("memory at {:#x}, {} bytes, is read only and comes without a file", address,
                  bytes);
  } else if (files.empty()) {
    spdlog::warn("memory at {:#x}, {} bytes, comes without a file: the board cannot reach it",
                 address, bytes);
  } else {
    const bool writable = (flags & kWritable) != 0;
    range.memory.emplace_back(std::move(files.front()), offset, bytes, writable);
    try {
      function_.map(address, range.memory.front().bytes(), writable);
    } catch (const std::invalid_argument& e) {
      throw Refused(EINVAL, e.what());
    }
  }
  ranges_.emplace(address, std::move(range));
}

void DmaMaps::unmap(const DmaUnmap& command) {
  const auto [argsz, flags, address, bytes] = command;
  if (argsz < sizeof command) throw Refused(EINVAL, "memory without a whole description");
  if (flags == kUnmapAll && address == 0 && bytes == 0) {
    clear();
    return;
  }
  if (flags != 0) throw Refused(ENOTSUP, fmt::format("flags {:#x} of memory that goes", flags));
  if (bytes == 0 || last_of(address, bytes) < address) {
    throw Refused(EINVAL, fmt::format("memory of {} bytes at {:#x}", bytes, address));
  }
  const std::uint64_t last = last_of(address, bytes);
  const auto first = ranges_.lower_bound(address);
  const auto end = ranges_.upper_bound(last);
  const auto cut = [&](Ranges::const_iterator range, std::uint64_t at) {
    return range->first < at && last_of(range->first, range->second.bytes) >= at;
  };
  if (first != ranges_.begin() && cut(std::prev(first), address)) {
    throw Refused(EINVAL, "a part of a range of memory");
  }
  // As the kernel's VFIO has it: QEMU unmaps whatever a virtual IOMMU may have had mapped.
  if (first == end) return;
  if (last_of(std::prev(end)->first, std::prev(end)->second.bytes) > last) {
    throw Refused(EINVAL, "a part of a range of memory");
  }
  for (auto range = first; range != end;) range = remove(range);
}

DmaMaps::Ranges::iterator DmaMaps::remove(Ranges::iterator range) {
  if (!range->second.memory.empty()) function_.unmap(range->first, range->second.bytes);
  return ranges_.erase(range);
}

void DmaMaps::clear() {
  while (!ranges_.empty()) remove(ranges_.begin());
}

}  // namespace hvp::serve
