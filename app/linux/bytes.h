#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

namespace hvp::guest {

// Reads and writes a number in bytes, in this machine's byte order, which is also the guest's. The
// caller has checked the length.
template <class T>
T number_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  static_assert(std::is_trivially_copyable_v<T>);
  T value;
  std::memcpy(&value, bytes.subspan(at, sizeof value).data(), sizeof value);
  return value;
}

template <class T>
void put_number(std::span<std::uint8_t> bytes, std::size_t at, T value) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::memcpy(bytes.subspan(at, sizeof value).data(), &value, sizeof value);
}

}  // namespace hvp::guest
