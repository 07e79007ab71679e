#include "app/linux/guest_memory.h"

#include <cerrno>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/linux/guest_error.h"

namespace hvp::guest {

void GuestMemory::add(const vhost::Region& region, std::span<std::uint8_t> bytes) {
  const std::uint64_t last = region.guest + (region.size - 1);
  if (bytes.empty() || bytes.size() != region.size || last < region.guest) {
    throw GuestError(
        fmt::format("vhost-user: {:#x} bytes of memory at {:#x}", region.size, region.guest));
  }
  for (const Range& range : ranges_) {
    if (region.guest <= range.guest + (range.bytes.size() - 1) && last >= range.guest) {
      throw GuestError(fmt::format("vhost-user: memory at {:#x} overlaps that at {:#x}",
                                   region.guest, range.guest));
    }
  }
  ranges_.push_back({region.guest, region.user, bytes});
}

std::span<std::uint8_t> GuestMemory::at(std::uint64_t address, std::size_t bytes,
                                        std::size_t alignment) const {
  if (address % alignment != 0) {
    throw GuestError(
        fmt::format("the guest's address {:#x} is no multiple of {}", address, alignment));
  }
  for (const Range& range : ranges_) {
    if (address < range.guest) continue;
    const std::uint64_t offset = address - range.guest;
    if (offset > range.bytes.size() || bytes > range.bytes.size() - offset) continue;
    return range.bytes.subspan(offset, bytes);
  }
  throw GuestError(
      fmt::format("the guest names {:#x} bytes at {:#x}, where it has no memory", bytes, address));
}

std::uint64_t GuestMemory::from_user(std::uint64_t address) const {
  for (const Range& range : ranges_) {
    if (address >= range.user && address - range.user < range.bytes.size()) {
      return range.guest + (address - range.user);
    }
  }
  throw GuestError(fmt::format("the guest's ring is at {:#x}, where it has no memory", address));
}

MappedFile::MappedFile(int descriptor, std::uint64_t offset, std::uint64_t bytes) {
  struct stat status {};
  const bool there = fstat(descriptor, &status) == 0 && bytes > 0 && status.st_size > 0 &&
                     offset <= static_cast<std::uint64_t>(status.st_size) &&
                     bytes <= static_cast<std::uint64_t>(status.st_size) - offset;
  if (!there) {
    throw GuestError(fmt::format("the guest's memory of {} bytes is not in its file", bytes));
  }
  const std::uint64_t within = offset % static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  length_ = bytes + within;
  mapping_ = mmap(nullptr, length_, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor,
                  static_cast<off_t>(offset - within));
  if (mapping_ == MAP_FAILED) {
    throw GuestError(fmt::format("the guest's memory cannot be shared: {}",
                                 std::generic_category().message(errno)));
  }
  bytes_ = {static_cast<std::uint8_t*>(mapping_) + within, bytes};
}

MappedFile::~MappedFile() {
  if (mapping_ != nullptr) munmap(mapping_, length_);
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : mapping_(std::exchange(other.mapping_, nullptr)),
      length_(other.length_),
      bytes_(other.bytes_) {}

}  // namespace hvp::guest
