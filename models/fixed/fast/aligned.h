#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace hvp::fixed::fast {

// Every vector starts at a cache line and ends with one: passes over it run in whole lines, and
// reads a little beyond the last entry stay inside.
inline constexpr std::size_t kLine = 64;

template <typename T>
struct LineAllocator {
  using value_type = T;  // NOLINT(readability-identifier-naming): the library's name
  LineAllocator() = default;
  template <typename U>
  explicit LineAllocator(const LineAllocator<U>& /*other*/) {}
  T* allocate(std::size_t n) {
    return static_cast<T*>(::operator new (n * sizeof(T), std::align_val_t{kLine}));
  }
  void deallocate(T* p, std::size_t /*n*/) { ::operator delete (p, std::align_val_t{kLine}); }
  friend bool operator==(const LineAllocator&, const LineAllocator&) { return true; }
};

template <typename T>
using Aligned = std::vector<T, LineAllocator<T>>;

}  // namespace hvp::fixed::fast
