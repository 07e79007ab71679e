#pragma once

#include <cstdint>
#include <string_view>

namespace hvp::random {

// Uniform numbers for one effect. A number depends on the seed, the effect's name, the frame and
// which draw of the frame it is; on nothing that was drawn before. An effect that is taken away, or
// a frame that is skipped, leaves all other draws as they are.
class Draws {
 public:
  Draws(std::int64_t seed, std::string_view effect);

  // Two numbers in (0, 1) with 53 bits each.
  struct Pair {
    double first;
    double second;
  };
  // `draw` counts the draws of a frame and `attempt` how often one is made again, below 2^16 both.
  Pair uniform(std::int64_t frame, std::uint32_t draw = 0, std::uint32_t attempt = 0) const;

 private:
  std::uint64_t seed_;
  std::uint32_t effect_;
};

}  // namespace hvp::random
