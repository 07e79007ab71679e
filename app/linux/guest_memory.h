#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "app/linux/vhost_user.h"

namespace hvp::guest {

// The memory that the guest shares: its address ranges and where they are in this process. Every
// address from the guest passes through at(). GuestMemory does not own the memory.
class GuestMemory {
 public:
  // `bytes` has the size that the region states. Throws GuestError if the region is empty, reaches
  // beyond the last address or overlaps another one.
  void add(const vhost::Region& region, std::span<std::uint8_t> bytes);
  void clear() { ranges_.clear(); }

  // Returns `bytes` bytes at the guest's address. Throws GuestError if they are not all in one
  // region, or if the address is no multiple of `alignment`.
  std::span<std::uint8_t> at(std::uint64_t address, std::size_t bytes,
                             std::size_t alignment = 1) const;
  // Converts an address in the units in which rings are given to one of the guest. Throws
  // GuestError.
  std::uint64_t from_user(std::uint64_t address) const;

 private:
  struct Range {
    std::uint64_t guest;
    std::uint64_t user;
    std::span<std::uint8_t> bytes;
  };
  std::vector<Range> ranges_;
};

// A part of another process' file, mapped and shared.
class MappedFile {
 public:
  // Throws GuestError if the file ends before that part, or cannot be mapped.
  MappedFile(int descriptor, std::uint64_t offset, std::uint64_t bytes);
  ~MappedFile();
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&&) = delete;

  std::span<std::uint8_t> bytes() const { return bytes_; }

 private:
  void* mapping_ = nullptr;  // starts with the page in which `bytes_` begins
  std::size_t length_ = 0;
  std::span<std::uint8_t> bytes_;
};

}  // namespace hvp::guest
