#include "models/random/draws.h"

#include <array>

namespace hvp::random {

namespace {
// Salmon et al., Table 2 and section 3.3.
constexpr std::uint64_t kMultiplier0 = 0xD2511F53;
constexpr std::uint64_t kMultiplier1 = 0xCD9E8D57;
constexpr std::uint32_t kWeyl0 = 0x9E3779B9;
constexpr std::uint32_t kWeyl1 = 0xBB67AE85;
constexpr int kRounds = 10;

std::uint32_t high(std::uint64_t product) { return static_cast<std::uint32_t>(product >> 32U); }
std::uint32_t low(std::uint64_t product) { return static_cast<std::uint32_t>(product); }
}  // namespace

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                    std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < kRounds; ++round) {
    const std::uint64_t first = kMultiplier0 * counter[0];
    const std::uint64_t second = kMultiplier1 * counter[2];
    counter = {high(second) ^ counter[1] ^ key[0], low(second), high(first) ^ counter[3] ^ key[1],
               low(first)};
    key[0] += kWeyl0;
    key[1] += kWeyl1;
  }
  return counter;
}

namespace {

// FNV-1a: an effect is told from another by its name, not by its place in a list.
std::uint32_t hash(std::string_view text) {
  std::uint32_t h = 2166136261U;
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 16777619U;
  return h;
}

}  // namespace

Draws::Draws(std::int64_t seed, std::string_view effect)
    : seed_(static_cast<std::uint64_t>(seed)), effect_(hash(effect)) {}

Draws::Pair Draws::uniform(std::int64_t frame, std::uint32_t draw, std::uint32_t attempt) const {
  const auto number = static_cast<std::uint64_t>(frame);
  const auto low = [](std::uint64_t v) { return static_cast<std::uint32_t>(v); };
  const auto high = [](std::uint64_t v) { return static_cast<std::uint32_t>(v >> 32U); };
  const std::array<std::uint32_t, 4> word = philox(
      {low(number), high(number), effect_, draw << 16U | attempt}, {low(seed_), high(seed_)});
  // The middle of one of 2^53 equal parts, so that neither 0 nor 1 comes up.
  const auto fraction = [](std::uint32_t upper, std::uint32_t lower) {
    const std::uint64_t bits = (std::uint64_t{upper} << 32U | lower) >> 11U;
    return (static_cast<double>(bits) + 0.5) * 0x1p-53;
  };
  return {fraction(word[0], word[1]), fraction(word[2], word[3])};
}

}  // namespace hvp::random
