#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "app/linux/vhost_user.h"

namespace hvp::guest {

// The guest's memory as it has given it to us: which addresses there are, and where they are here.
// Every address that comes from the guest goes through at(). It does not own the memory.
class GuestMemory {
 public:
  // `bytes` are as many as the region says. Throws GuestError where it is empty, reaches beyond the
  // last address or overlaps another one.
  void add(const vhost::Region& region, std::span<std::uint8_t> bytes);
  void clear() { ranges_.clear(); }

  // That many bytes from an address on. Throws GuestError where they are not all in one region, or
  // the address is no multiple of `alignment`.
  std::span<std::uint8_t> at(std::uint64_t address, std::size_t bytes,
                             std::size_t alignment = 1) const;
  // The guest's address of one in the units that rings are given in. Throws GuestError.
  std::uint64_t from_user(std::uint64_t address) const;

 private:
  struct Range {
    std::uint64_t guest;
    std::uint64_t user;
    std::span<std::uint8_t> bytes;
  };
  std::vector<Range> ranges_;
};

}  // namespace hvp::guest
