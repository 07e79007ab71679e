#pragma once

#include <cstddef>

namespace hvp::vp::engine {

// Positions of the ranks of a pipeline in arrays that stay where they are: what has entered at one
// edge is found `age` edges later in the same slot, so that no rank is copied to the next.
class Ranks {
 public:
  // For ages 0 to `depth`.
  explicit Ranks(int depth) : size_(static_cast<std::size_t>(depth) + 1) {}

  std::size_t size() const { return size_; }
  std::size_t entering() const { return newest_; }
  std::size_t slot(int age) const {
    const auto back = static_cast<std::size_t>(age);
    return newest_ >= back ? newest_ - back : newest_ + size_ - back;
  }
  // At the beginning of an edge: the slot of what enters at it.
  void advance() { newest_ = newest_ + 1 == size_ ? 0 : newest_ + 1; }

 private:
  std::size_t size_;
  std::size_t newest_ = 0;
};

}  // namespace hvp::vp::engine
