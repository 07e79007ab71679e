// How the engine's structures become blocks, against counts by hand from the blocks' data sheets,
// and what a refusal proposes.
#include "models/accel/memory.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/devices/devices.h"
#include "models/accel/critical_path.h"
#include "models/accel/fit.h"
#include "models/accel/multipliers.h"
#include "models/accel/partition.h"
#include "models/config/input_error.h"

namespace hvp::accel::memory_test {
namespace {

using fixed::Method;
using testing::ElementsAre;
using testing::HasSubstr;

const Device& device(const char* name) { return devices::built_in(name); }

Pattern thesis_mesh(int nodes = 500) {
  return {std::vector<int>(static_cast<std::size_t>(nodes), 13)};
}

Allocation allocation(const Usage& u, const std::string& use) {
  const auto found = std::ranges::find(u.allocations, use, &Allocation::use);
  return found == u.allocations.end() ? Allocation{} : *found;
}

int used(const Usage& u, const std::string& type) {
  const auto found = std::ranges::find(u.resources, type, &Resource::type);
  return found == u.resources.end() ? -1 : found->used;
}

std::int64_t blocks(const char* type, const Structure& s, const Architecture& a = {}) {
  return blocks_of(*device("EP2S60").memory(type), s, a);
}

// Fig. 5.8: three M4K give 1 K words of 12 bits, eight of them a clock from both ports.
TEST(Blocks, ThreeM4kAreTheBasicUnit) {
  const auto unit = [](std::int64_t packages) {
    return blocks("M4K", {"", Role::matrix, 1, packages, 8 * 12, Access::stream});
  };
  EXPECT_EQ(unit(128), 3);
  EXPECT_EQ(unit(512), 12);
  EXPECT_EQ(unit(513), 15);
  // One column of a package a bit wide: from one port 4096 deep, whatever the other one does.
  EXPECT_EQ(blocks("M4K", {"", Role::matrix, 1, 4096, 1, Access::stream}), 1);
  EXPECT_EQ(blocks("M4K", {"", Role::matrix, 1, 4097, 1, Access::stream}), 2);
}

// The matrix editor reads a package and writes another one in the same clock. Both ports that read
// half a package each leave it none; one that reads and one that writes take as many blocks, but
// where a block reads its widest word from either port.
TEST(Blocks, AMatrixThatIsChangedTakesNoMore) {
  int types = 0;
  for (const Device* d : devices::all_built_in()) {
    for (const MemoryType& type : d->memories) {
      if (type.two_port_bits == type.read_write_bits) continue;
      ++types;
      for (const bool parity_bits : {false, true}) {
        Architecture a;
        a.parity_bits = parity_bits;
        for (std::int64_t packages = 1; packages < 4000; packages = packages * 4 / 3 + 1) {
          for (const std::int64_t width : {64, 96, 120, 192, 256}) {
            Structure matrix{"", Role::matrix, 1, packages, width, Access::read_write};
            const std::int64_t changed = blocks_of(type, matrix, a);
            matrix.access = Access::stream;
            EXPECT_EQ(changed, blocks_of(type, matrix, a)) << d->name << ' ' << type.name;
          }
        }
      }
    }
  }
  EXPECT_GT(types, 20);
}

// A fewest-blocks rule can only gain from what a structure asks less for.
TEST(Blocks, AskingForLessNeverTakesMore) {
  for (const char* type : {"M512", "M4K", "M-RAM"}) {
    for (std::int64_t depth = 1; depth < 2000; depth = depth * 3 / 2 + 1) {
      for (std::int64_t width = 1; width < 300; width = width * 3 / 2 + 1) {
        const Structure stream{"", Role::vectors, 1, depth, width, Access::stream};
        Structure both = stream;
        both.access = Access::read_write;
        Structure deeper = stream;
        deeper.depth += 7;
        Structure wider = stream;
        wider.width += 3;
        Architecture parity;
        parity.parity_bits = true;
        const std::int64_t base = blocks(type, stream);
        EXPECT_LE(base, blocks(type, both));
        EXPECT_LE(base, blocks(type, deeper));
        EXPECT_LE(base, blocks(type, wider));
        EXPECT_GE(base, blocks(type, stream, parity));
        // No more bits than the blocks have.
        EXPECT_GE(base * device("EP2S60").memory(type)->bits, depth * width);
      }
    }
  }
}

// Footnote of §5.4: with parity 16, 24 and 32 bits become 18, 27 and 36.
TEST(Blocks, ParityWidensWordsOfWholeBytes) {
  const auto vector = [](std::int64_t bits, bool parity) {
    Architecture a;
    a.parity_bits = parity;
    return blocks("M4K", {"", Role::vectors, 1, 256, bits, Access::read_write}, a);
  };
  EXPECT_EQ(vector(18, false), 2);
  EXPECT_EQ(vector(18, true), 1);
  EXPECT_EQ(vector(36, true), 2);
  EXPECT_EQ(vector(37, true), 3);
  // M20K: 512 × 40, 1 K × 20, 2 K × 10 and 4 K × 5, but 8 K × 2 and 16 K × 1.
  const MemoryType& m20k = *device("5SGXA7").memory("M20K");
  Architecture a;
  a.parity_bits = true;
  const auto m20k_blocks = [&](std::int64_t depth, std::int64_t width) {
    return blocks_of(m20k, {"", Role::vectors, 1, depth, width, Access::read_write}, a);
  };
  EXPECT_EQ(m20k_blocks(512, 40), 1);
  EXPECT_EQ(m20k_blocks(1024, 20), 1);
  EXPECT_EQ(m20k_blocks(4096, 5), 1);
  EXPECT_EQ(m20k_blocks(8192, 3), 2);
  EXPECT_EQ(m20k_blocks(16384, 1), 1);
}

TEST(Blocks, TwoPortsAtTwiceTheClockGiveFourAccesses) {
  Structure d{"d", Role::copies, 1, 256, 16, Access::anywhere, 4};
  Architecture a;
  EXPECT_EQ(blocks("M4K", d, a), 1);
  a.clock_hz = 275e6;  // half of the M4K's 550 MHz
  EXPECT_EQ(blocks("M4K", d, a), 1);
  a.clock_hz = 276e6;
  EXPECT_EQ(blocks("M4K", d, a), -1);
  EXPECT_EQ(why_not(*device("EP2S60").memory("M4K"), d, a),
            "d has to run at 2 times the clock, 552 MHz, and the limit of the M4K is 550 MHz");
  d.accesses = 2;
  EXPECT_EQ(blocks("M4K", d, a), 1);
  // An M512 reads with one port and writes with the other.
  EXPECT_EQ(blocks("M512", d, a), -1);
  EXPECT_EQ(why_not(*device("EP2S60").memory("M512"), d, a),
            "the M512 has no two ports that read anywhere, as d needs");
}

TEST(Allocation, MoreNodesAClockNeedMoreMemories) {
  // 500 words of 16 bits: 2 × 250 in two M4K a component, and 4 × 125 in four.
  const auto x = [](int lanes) {
    Architecture a;
    a.nodes_per_clock = lanes;
    return allocation(usage(device("EP2S60"), a, {}, thesis_mesh()), "x").blocks;
  };
  EXPECT_EQ(x(1), 3 * 2);
  EXPECT_EQ(x(2), 3 * 2);
  EXPECT_EQ(x(4), 3 * 4);
  EXPECT_EQ(x(8), 3 * 8);
}

// 500 packages of eight 12-bit words for each of 15 memories are 125 words of two ports of 64 bits:
// an M-RAM holds them in a corner, and gives no more than one package a clock of them.
TEST(Allocation, TheMatrixTakesAnMRamForEveryMemory) {
  Architecture a;
  a.matrix_memory = "M-RAM";
  const Usage u = usage(device("EP2S60"), a, {}, thesis_mesh());
  EXPECT_EQ(allocation(u, "matrix").blocks, 15);
  EXPECT_EQ(used(u, "M4K"), 60);
  EXPECT_FALSE(u.fits());
}

TEST(Allocation, RowsThatWaitAreExactSumsAndTheWordsOfTheirNode) {
  // Three sums of 12 + 16 + 6 bits (39 products), three words, a node's number of nine bits: ten
  // M512 of 16 bits in each partition.
  const Allocation results = allocation(usage(device("EP2S60"), {}, {}, thesis_mesh()), "results");
  EXPECT_EQ(results.type, "M512");
  EXPECT_EQ(results.width, 3 * (34 + 16) + 9);
  EXPECT_EQ(results.depth, 16);
  EXPECT_EQ(results.blocks, 5 * 10);
}

TEST(Allocation, AutoPutsTheIndexIntoTheLargestBlocks) {
  const Usage u = usage(device("U280"), {}, {}, thesis_mesh());
  EXPECT_EQ(allocation(u, "index").type, "URAM");
  EXPECT_EQ(allocation(u, "matrix").type, "BRAM36");
  // 185 bits: two URAM give 128 each from both ports. 96 bits: two BRAM36 of 64.
  EXPECT_EQ(allocation(u, "index").blocks, 2);
  EXPECT_EQ(allocation(u, "matrix").blocks, 15 * 2);
}

TEST(Multipliers, PiecesAreSigned) {
  const MultiplierMode m18{.name = "", .count = 1, .bits = 18, .other_bits = 18, .source = ""};
  EXPECT_EQ(multipliers_a_product(m18, 18, 18), 1);
  EXPECT_EQ(multipliers_a_product(m18, 19, 18), 2);
  EXPECT_EQ(multipliers_a_product(m18, 35, 18), 2);
  EXPECT_EQ(multipliers_a_product(m18, 36, 18), 3);
  EXPECT_EQ(multipliers_a_product(m18, 32, 32), 4);
  const MultiplierMode dsp48{.name = "", .count = 1, .bits = 27, .other_bits = 18, .source = ""};
  EXPECT_EQ(multipliers_a_product(dsp48, 18, 24), 1);
  EXPECT_EQ(multipliers_a_product(dsp48, 24, 24), 2);
  const MultiplierMode dsp58{.name = "", .count = 1, .bits = 27, .other_bits = 24, .source = ""};
  EXPECT_EQ(multipliers_a_product(dsp58, 24, 24), 1);
}

// Mafi et al. 2010 and the ring of four EP3SE110 (230.4 GOPS = 4 · 16 · 36 · 100 MHz) have 16
// partitions on a chip for which Table 6.4 says 32: it gives its full count only in sums of four.
TEST(Multipliers, AnEp3se110HasSixteenPartitionsOrThirtyTwo) {
  const auto fits = [](const char* mode, int partitions) {
    Architecture a;
    a.multiplier_mode = mode;
    a.partitions = partitions;
    const Usage u = usage(device("EP3SE110"), a, {}, thesis_mesh());
    return std::ranges::all_of(u.resources, [](const Resource& r) {
      return r.type != "multipliers" || r.used <= r.available;
    });
  };
  EXPECT_TRUE(fits("independent", 16));
  EXPECT_FALSE(fits("independent", 32));
  EXPECT_TRUE(fits("sum-of-four", 32));
  Architecture a;
  a.multiplier_mode = "sum-of-four";
  // 120 products in sums; each of the other 21 keeps another one from use.
  EXPECT_EQ(multipliers(device("EP3SE110"), a, {}), 120 + 2 * 21);
  a.package = 6;  // two sums of four, half of the second unused
  EXPECT_EQ(multipliers(device("EP3SE110"), a, {}), 120 + 2 * 21);
}

// d is there for every partition: more of them hold fewer nodes. An independent count by bits,
// which asks for no whole blocks and no ports, has 1794 with 32 partitions and 2357 with 16; whole
// blocks hold fewer.
TEST(LargestMesh, FallsWithPartitions) {
  const auto nodes = [](int partitions) {
    Architecture a;
    a.partitions = partitions;
    a.multiplier_mode = "sum-of-four";
    return largest_mesh(device("EP3SE110"), a, {}, thesis_mesh());
  };
  EXPECT_GT(nodes(16), nodes(32));
  EXPECT_LT(nodes(16), 2357);
  EXPECT_LT(nodes(32), 1794);
  EXPECT_GT(nodes(32), 1000);
}

// Equation 5.1 gives 11 % for 36 non-zeros a row; rows of 12 blocks fill 40 of five packages, and
// 36 of 36 with packages of twelve.
TEST(Packing, PaddingIsWhatRowsLackToWholePackages) {
  // Half a package of padding a row.
  const double expected_loss = 8 / 2.0 / 36;
  EXPECT_NEAR(expected_loss, 0.11, 0.002);
  const Pattern p{std::vector<int>(503, 12)};
  const Packing eight = packing({}, p);
  EXPECT_EQ(eight.nonzeros, 503 * 108);
  EXPECT_EQ(eight.stored, 503 * 3 * 40);
  EXPECT_DOUBLE_EQ(eight.loss(), 4.0 / 36);
  // 503 rows over five partitions: two of them have a row less.
  EXPECT_EQ(eight.balance.fullest, 101 * 5);
  EXPECT_EQ(eight.balance.emptiest, 100 * 5);
  Architecture twelve;
  twelve.package = 12;
  EXPECT_EQ(packing(twelve, p).loss(), 0);
}

TEST(Fit, EveryProposalFits) {
  const std::vector<const Device*> others = devices::all_built_in();
  const Device& small = device("EP2S60");
  const WordLengths pcg{.method = Method::jacobi_pcg};
  EXPECT_THAT(what_would_fit(small, {}, pcg, thesis_mesh(426), others),
              testing::Contains("accelerator.device = \"EP2S180\""));
  // 1000 nodes: only another device.
  EXPECT_THAT(what_would_fit(small, {}, {}, thesis_mesh(1000), others),
              ElementsAre("accelerator.device = \"EP2S180\""));
  Architecture a;
  a.partitions = 6;
  EXPECT_THAT(what_would_fit(small, a, {}, thesis_mesh(300), {}),
              ElementsAre("accelerator.partitions = 5"));
  a.partitions = 5;
  EXPECT_TRUE(usage(small, a, {}, thesis_mesh(300)).fits());
  // 18-bit vectors take a block more everywhere unless their parity bits hold data.
  const WordLengths wide{.vector_bits = 18};
  EXPECT_FALSE(usage(small, {}, wide, thesis_mesh()).fits());
  EXPECT_THAT(what_would_fit(small, {}, wide, thesis_mesh(), {}),
              testing::Contains("accelerator.parity_bits = true"));
  a.parity_bits = true;
  EXPECT_TRUE(usage(small, a, wide, thesis_mesh()).fits());
}

// A proposal that the clock refuses is none: fewer partitions that fit, but too fast for them.
TEST(Fit, EveryProposalReachesTheClock) {
  const Device& d = device("EP2S180");
  Architecture a;
  a.partitions = 40;
  const auto proposed = [&](double clock_hz) {
    a.clock_hz = clock_hz;
    return what_would_fit(d, a, {}, thesis_mesh(), {});
  };
  ASSERT_THAT(proposed(100e6), testing::Contains("accelerator.partitions = 15"));
  Architecture fifteen = a;
  fifteen.partitions = 15;
  const double reached = highest_clock({d, fifteen, {}, 500});
  EXPECT_THAT(proposed(reached * 1.0001),
              testing::Not(testing::Contains("accelerator.partitions = 15")));
}

// A device with other memory types is proposed with what has to go; one that has them, without.
TEST(Fit, AnotherDeviceComesWithItsOwnMemoryTypes) {
  Architecture a;
  a.preconditioner_memory = "M512";
  const WordLengths pcg{.method = Method::jacobi_pcg};
  const std::vector<const Device*> stratix = {&device("EP2S180")};
  EXPECT_THAT(what_would_fit(device("EP2S60"), a, pcg, thesis_mesh(800), stratix),
              testing::Contains("accelerator.device = \"EP2S180\""));
  const std::vector<const Device*> other = {&device("5SGXA7")};
  EXPECT_THAT(what_would_fit(device("EP2S60"), a, pcg, thesis_mesh(2000), other),
              ElementsAre("accelerator.device = \"5SGXA7\" with every memory key and "
                          "multiplier_mode left out"));
  EXPECT_THROW(usage(device("5SGXA7"), a, pcg, thesis_mesh(2000)), InputError);
  EXPECT_TRUE(usage(device("5SGXA7"), {}, pcg, thesis_mesh(2000)).fits());
}

TEST(Fit, ARefusalSaysWhatAStructureMisses) {
  Architecture a;
  a.copies_memory = "M512";
  try {
    require_fit(device("EP2S60"), a, {}, thesis_mesh(), {}, 580);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(e.key(), "device");
    EXPECT_THAT(e.what(), HasSubstr("the M512 has no two ports that read anywhere, as d needs"));
    EXPECT_THAT(e.what(), HasSubstr("accelerator.copies_memory = \"M4K\""));
  }
  try {
    require_fit(device("EP2S60"), {}, {}, thesis_mesh(1000), {}, 1200);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("about 512 nodes with such rows (object.mesh.nodes = 595)"));
  }
}

}  // namespace
}  // namespace hvp::accel::memory_test
