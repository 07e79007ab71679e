// ecp5_double_pumped_memory.sv with its second clock, on a model of the block RAM, against
// double_pumped_memory.sv, which the engine is simulated with.
#include <array>
#include <cstdint>
#include <type_traits>

#include <gtest/gtest.h>

#include "tests/vp/engine/clocked_module.h"
// Behind it, as it has what Verilator's headers expect.
#include <Vdouble_pumped_pair.h>
#include <Vdouble_pumped_pair_deep.h>
#include <Vdouble_pumped_pair_late.h>
#include <Vdouble_pumped_pair_two.h>

#include "tests/fixed/elastic_box.h"

namespace hvp::vp::rtl::rtl_memory_test {
namespace {

// What both take at the edges of the engine's clock.
template <class Top>
class Pair {
 public:
  Pair() : top_(&context_) {
    top_.clock = 0;
    top_.clock2 = 0;
    top_.eval();
  }
  ~Pair() { top_.final(); }
  Pair(const Pair&) = delete;
  Pair& operator=(const Pair&) = delete;

  Top* operator->() { return &top_; }

  // To the next edge of the engine's clock: the other clock has an edge before it, at which the
  // ports have their values already.
  void tick() {
    edge(0, 1);
    edge(0, 0);
    edge(1, 1);
    edge(1, 0);
  }

 private:
  void edge(int clock, int clock2) {
    top_.clock = static_cast<std::uint8_t>(clock);
    top_.clock2 = static_cast<std::uint8_t>(clock2);
    top_.eval();
  }

  VerilatedContext context_;
  Top top_;
};

struct Counts {
  int products = 0;
  int passes = 0;
  int writes = 0;
};

// Products and passes in any order, each of a few clocks, and one with neither before a product; a
// word is written in the clock before it is read at the soonest. `addresses` is 2^AddressBits.
template <class Top>
Counts compare(std::uint64_t seed, int address_bits, int width, int lanes, int clocks) {
  Pair<Top> pair;
  fixed::test::Random random(seed);
  const std::uint64_t addresses = std::uint64_t{1} << address_bits;
  const std::uint64_t word_mask = (std::uint64_t{1} << width) - 1;
  enum class Reads { product, pass, none };
  // What the clocks read, for those whose words are taken now.
  std::array<Reads, 3> before{Reads::none, Reads::none, Reads::none};
  Counts counts;
  bool product = false;
  bool idle = false;
  std::uint64_t last_written = 0;
  bool written = false;
  const auto write = [&](std::uint64_t address) {
    pair->write = static_cast<std::uint8_t>(lanes == 2 ? 1 + random.below(3) : 1);
    pair->write_address = static_cast<std::uint16_t>(address);
    // Two words are as wide as the port, which is another type in each size.
    pair->write_word = static_cast<std::remove_cvref_t<decltype(pair->write_word)>>(
        (random.bits() & word_mask) << width | (random.bits() & word_mask));
    ++counts.writes;
  };
  // All words first.
  for (std::uint64_t a = 0; a < addresses; ++a) {
    write(a);
    pair->write = 1;
    pair.tick();
  }
  counts.writes = 0;
  for (int i = 0; i < clocks; ++i) {
    if (idle) {
      product = true;
      idle = false;
    } else if (random.below(4) == 0) {
      idle = !product;
      product = false;
    }
    // Reads of words other than those that this clock writes.
    last_written = random.bits() % addresses;
    written = !product && !idle && random.below(2) == 0;
    pair->write = 0;
    if (written) write(last_written);
    const auto elsewhere = [&] {
      return (last_written + 2 + random.bits() % (addresses - 4)) % addresses;
    };
    pair->product = product ? 1 : 0;
    std::uint64_t packed = 0;
    for (int n = 0; n < 4; ++n) packed = packed << address_bits | elsewhere();
    pair->package_address = packed;
    pair->pass_address = static_cast<std::uint16_t>(elsewhere());
    pair.tick();
    // An address that is seen at an edge has its word taken two edges later.
    if (i >= 4) {
      if (before[1] == Reads::product) {
        EXPECT_EQ(pair->word, pair->ecp5_word) << "clock " << i;
        ++counts.products;
      } else if (before[1] == Reads::pass) {
        EXPECT_EQ(pair->pass_word, pair->ecp5_pass_word) << "clock " << i;
        ++counts.passes;
      }
      if (testing::Test::HasFailure()) break;
    }
    const Reads now = product ? Reads::product : idle ? Reads::none : Reads::pass;
    before = {now, before[0], before[1]};
  }
  return counts;
}

// One block of 1024 words, with addresses out of registers and with others, five of 2048 for one
// lane and three nodes a package, and one for two nodes, of which a product needs no second half.
TEST(RtlMemory, BlocksAtTwiceTheClockAreTheMemoryOfD) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Counts one = compare<Vdouble_pumped_pair>(seed, 10, 16, 2, 20'000);
    const Counts late = compare<Vdouble_pumped_pair_late>(seed, 10, 16, 2, 20'000);
    const Counts deep = compare<Vdouble_pumped_pair_deep>(seed, 11, 20, 1, 20'000);
    const Counts two = compare<Vdouble_pumped_pair_two>(seed, 10, 16, 1, 20'000);
    for (const Counts& c : {one, late, deep, two}) {
      EXPECT_GT(c.products, 5'000);
      EXPECT_GT(c.passes, 5'000);
      EXPECT_GT(c.writes, 2'000);
    }
  }
}

}  // namespace
}  // namespace hvp::vp::rtl::rtl_memory_test
