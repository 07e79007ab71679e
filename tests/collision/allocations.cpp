#include "tests/collision/allocations.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

// A file of its own: seen together with its callers, gcc warns of new and delete that differ.
namespace {
std::atomic<long> count{0};
}  // namespace

void* operator new(std::size_t size) {
  ++count;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace hvp::collision::test {

long allocations() { return count; }

}  // namespace hvp::collision::test
