// Whatever software does to the registers, the board stays whole. Runs under the sanitizers too.
#include <array>
#include <cstdint>
#include <span>

#include <gtest/gtest.h>

#include "tests/driver/driver_on_board.h"

namespace hvp::test::register_fuzz_test {
namespace {

// SplitMix64 (Steele, Lea, Flood, OOPSLA 2014): the same numbers everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t operator()() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15U;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9U;
    z = (z ^ z >> 27) * 0x94d049bb133111ebU;
    return z ^ z >> 31;
  }
  std::uint64_t below(std::uint64_t limit) { return (*this)() % limit; }

 private:
  std::uint64_t state_;
};

// Near the places where something could go wrong: registers, ends of memories, anything.
std::uint64_t some_offset(Random& random, const vp::RegisterBank& bank) {
  switch (random.below(4)) {
    case 0:
      return 4 * random.below(vp::kRegisterBytes / 4 + 2);
    case 1: {
      const auto i = random.below(vp::kApertures.size());
      const std::uint64_t end =
          vp::kApertures[i].offset + 4 * bank.memory(static_cast<vp::Aperture>(i)).size();
      return end - 64 + 4 * random.below(20);
    }
    case 2:
      return random.below(vp::kBarBytes);
    default:
      return random();
  }
}

TEST(RegisterFuzz, AHundredThousandAccessesToTheBank) {
  Random random(1);
  vp::RegisterBank bank({.nodes = 16, .row_blocks = 8, .blocks = 64});
  std::array<std::uint8_t, 96> data{};
  std::size_t allowed = 0;
  for (int i = 0; i < 100'000; ++i) {
    const std::uint64_t offset = some_offset(random, bank);
    const std::array<std::size_t, 4> sizes = {4, 4, 4 * random.below(data.size() / 4),
                                              random.below(data.size())};
    const std::span<std::uint8_t> bytes(data.data(), sizes[random.below(sizes.size())]);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    if (random.below(50) == 0) {
      bank.set(vp::field::kStatusBusy, static_cast<std::uint32_t>(random.below(2)));
    }
    const bool reading = random.below(2) == 0;
    const vp::AccessResult outcome = reading ? bank.read(offset, bytes) : bank.write(offset, bytes);
    if (outcome.ok()) {
      ++allowed;
    } else {
      ASSERT_FALSE(
          bank.describe(outcome, reading ? vp::Command::read : vp::Command::write).empty());
    }
  }
  EXPECT_GT(allowed, 10'000U);
  EXPECT_EQ(bank.get(vp::Register::id), 0x48565031U);
}

// The same through the board's commands, and then the driver gets it back to work.
TEST_F(DriverOnBoard, ComesBackAfterAHundredThousandRandomAccesses) {
  load();
  Random random(2);
  const hvp_bus bus = board.bus();
  std::array<std::uint32_t, 16> words{};
  for (int i = 0; i < 100'000; ++i) {
    const auto offset = static_cast<std::uint32_t>(some_offset(random, board.bank()));
    const std::size_t count = 1 + random.below(words.size());
    if (random.below(2) == 0) {
      bus.read_block(bus.context, offset, words.data(), count);
    } else {
      for (auto& word : words) word = static_cast<std::uint32_t>(random() >> random.below(64));
      bus.write_block(bus.context, offset, words.data(), count);
    }
    if (i % 1024 == 0) board.take_log();
  }
  ASSERT_EQ(hvp_reset(&device), HVP_OK);
  const hvp_solver_config config = thesis_config();
  const hvp_matrix view = matrix.view();
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
}

}  // namespace
}  // namespace hvp::test::register_fuzz_test
