#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace hvp::random {

// Philox4x32-10 (Salmon, Moraes, Dror & Shaw, "Parallel random numbers: as easy as 1, 2, 3",
// SC'11): a bijection of the counter that the key chooses. It has no state, so that a draw depends
// only on its counter and key.
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                    std::array<std::uint32_t, 2> key);

// Uniform numbers for one effect. A number depends on the seed, the effect's name, the frame and
// the number of the draw in the frame, and on no earlier draw. Without an effect or a frame, all
// other draws are the same.
class Draws {
 public:
  Draws(std::int64_t seed, std::string_view effect);

  // Two numbers in (0, 1) with 53 bits each.
  struct Pair {
    double first;
    double second;
  };
  // `draw` counts the draws of a frame and `attempt` the repetitions of one, both below 2^16.
  Pair uniform(std::int64_t frame, std::uint32_t draw = 0, std::uint32_t attempt = 0) const;
  // The numbers of an effect that belong to no frame, one after the other.
  Pair nth(std::int64_t number) const {
    return uniform(number >> 16U, static_cast<std::uint32_t>(number & 0xffff));
  }

 private:
  std::uint64_t seed_;
  std::uint32_t effect_;
};

}  // namespace hvp::random
