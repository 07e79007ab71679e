#include "models/accel/critical_path.h"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/devices/devices.h"
#include "models/config/input_error.h"

namespace hvp::accel::critical_path_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const Device& thesis_device() { return devices::built_in("EP2S60"); }

std::vector<ElementKind> kinds(const Path& path) {
  std::vector<ElementKind> found;
  for (const Element& element : path.elements) {
    if (element.kind != ElementKind::routing) found.push_back(element.kind);
  }
  return found;
}

double clock_of(const Architecture& a, const WordLengths& w = {}, int nodes = 500) {
  return highest_clock({thesis_device(), a, w, nodes});
}

// Thesis section 5.5: the timing analyser gives 100 MHz, and the board ran at that.
TEST(CriticalPath, TheThesisDesignReaches100Megahertz) {
  const double clock = clock_of({});
  EXPECT_GE(clock, 100.0e6);
  EXPECT_LE(clock, 105.0e6);
  EXPECT_NO_THROW(require_clock({thesis_device(), {}, {}, 500}));
}

// Thesis Fig. 5.10: 2x1 multiplexer, 16-bit absolute value, 16x16 multiplier, in d'(A d).
TEST(CriticalPath, IsThatOfFigure510) {
  const CriticalPath critical = critical_path({thesis_device(), {}, {}, 500});
  const Path& path = critical.paths.front();
  EXPECT_EQ(path.name, "inner product d'(A d)");
  using enum ElementKind;
  EXPECT_EQ(kinds(path), (std::vector{clock_to_out, multiplexer, absolute_value, absolute_value,
                                      multiplier, set_up}));
  EXPECT_THAT(text(path), AllOf(HasSubstr("2x1 multiplexer"), HasSubstr("16-bit absolute value"),
                                HasSubstr("16-bit multiplier")));
  EXPECT_DOUBLE_EQ(critical.highest_clock_hz, 1 / path.delay_s());
}

TEST(CriticalPath, TheQuickFunctionAndTheReportAgree) {
  for (const std::string_view name : devices::built_in_names()) {
    const Device& device = devices::built_in(name);
    ASSERT_TRUE(device.timing) << name;
    const Architecture a;
    const CriticalPath critical = critical_path({device, a, {}, 500});
    EXPECT_DOUBLE_EQ(highest_clock({device, a, {}, 500}), critical.highest_clock_hz) << name;
    EXPECT_TRUE(std::ranges::is_sorted(critical.paths, std::ranges::greater{}, &Path::period_s));
  }
}

// A pipelined absolute value takes the path apart. What is next is neither of its halves, so that a
// second register there would be of no use.
TEST(CriticalPath, ARegisterBehindTheAbsoluteValueMovesIt) {
  Architecture a;
  a.absolute_value_register = true;
  EXPECT_EQ(a.phase_clocks(), Architecture().phase_clocks() + 1);
  const CriticalPath moved = critical_path({thesis_device(), a, {}, 500});
  EXPECT_GT(moved.highest_clock_hz, 1.2 * clock_of({}));
  EXPECT_EQ(moved.paths.front().name, "choice of a result memory");
  for (const Path& path : moved.paths) {
    const auto k = kinds(path);
    EXPECT_FALSE(std::ranges::count(k, ElementKind::absolute_value) > 0 &&
                 std::ranges::count(k, ElementKind::multiplier) > 0)
        << path.name;
  }
}

// Nothing that is wider, deeper or more is faster.
TEST(CriticalPath, WiderIsNeverFaster) {
  const auto never_faster = [](const char* what, auto&& set, const std::vector<int>& values) {
    for (const bool registered : {false, true}) {
      for (const std::string_view name : devices::built_in_names()) {
        double before = std::numeric_limits<double>::infinity();
        for (const int value : values) {
          Architecture a;
          WordLengths w;
          int nodes = 500;
          a.absolute_value_register = registered;
          set(a, w, nodes, value);
          const double clock = highest_clock({devices::built_in(name), a, w, nodes});
          EXPECT_LE(clock, before) << what << " " << value << " on " << name;
          before = clock;
        }
      }
    }
  };
  const std::vector<int> words = {8, 10, 12, 14, 16, 17, 18, 19, 20, 22, 24, 27, 28, 32};
  never_faster(
      "matrix", [](auto&, auto& w, int&, int v) { w.matrix_bits = v; }, words);
  never_faster(
      "vector", [](auto&, auto& w, int&, int v) { w.vector_bits = v; }, words);
  never_faster(
      "coefficient", [](auto&, auto& w, int&, int v) { w.coefficient_bits = v; }, words);
  never_faster("scalar", [](auto&, auto& w, int&, int v) { w.scalar_bits = v; }, {64, 128});
  never_faster("PL2", [](auto& a, auto&, int&, int v) { a.package = v; }, {1, 2, 4, 8, 16, 64});
  never_faster("PL3", [](auto& a, auto&, int&, int v) { a.partitions = v; }, {1, 2, 5, 16, 64});
  never_faster("L", [](auto& a, auto&, int&, int v) { a.nodes_per_clock = v; }, {1, 2, 4, 16});
  never_faster("nodes", [](auto&, auto&, int& n, int v) { n = v; }, {2, 100, 500, 1000, 9000});
}

const Path* path_named(const CriticalPath& critical, std::string_view name) {
  const auto found = std::ranges::find(critical.paths, name, &Path::name);
  return found == critical.paths.end() ? nullptr : &*found;
}

constexpr std::string_view kNodeToBank = "node of a package to its bank of d";
constexpr std::string_view kWordFromBank = "word of d from its bank";

// vp/fpga/rtl/engine/bank_reads.sv and direction_copy.sv: engine `rows` of tables/synthesis, with
// three nodes of seven bits a package and eight banks, in look-up tables of four inputs.
TEST(CriticalPath, NodesGoToTheirBanksAndWordsComeBack) {
  Architecture a;
  a.package = 7;
  a.direction_banks = 8;
  const CriticalPath critical = critical_path({devices::built_in("LFE5U-85F"), a, {}, 127});
  const Path* node = path_named(critical, kNodeToBank);
  ASSERT_NE(node, nullptr);
  using enum ElementKind;
  EXPECT_EQ(kinds(*node), (std::vector{clock_to_out, gates, gates,  // 14 bits of two nodes
                                       gates,        // two nodes before, each counted and alike
                                       multiplexer,  // three numbers
                                       gates,  // two bits of a number, is it read, is it the bank
                                       gates, gates,  // three nodes, each chosen or not
                                       set_up}));
  EXPECT_EQ(node->transfers_per_clock, 1);
  const Path* word = path_named(critical, kWordFromBank);
  ASSERT_NE(word, nullptr);
  // Of 24 ports, and of three components.
  EXPECT_EQ(kinds(*word), (std::vector{memory_register, multiplexer, multiplexer, multiplexer,
                                       multiplexer, multiplexer, set_up}));
  EXPECT_EQ(word->transfers_per_clock, 2);
  a.direction_memory = DirectionMemory::two_copies;
  const CriticalPath copies = critical_path({devices::built_in("LFE5U-85F"), a, {}, 127});
  EXPECT_EQ(path_named(copies, kWordFromBank)->transfers_per_clock, 1);
}

// A port that is always the same node's has neither.
TEST(CriticalPath, OnlyWhatIsDealtHasBanks) {
  const auto dealt = [](int banks, int package, DirectionMemory memory) {
    Architecture a;
    a.direction_banks = banks;
    a.package = package;
    a.direction_memory = memory;
    const CriticalPath critical = critical_path({thesis_device(), a, {}, 500});
    const bool node = path_named(critical, kNodeToBank) != nullptr;
    EXPECT_EQ(node, path_named(critical, kWordFromBank) != nullptr);
    return node;
  };
  using enum DirectionMemory;
  EXPECT_FALSE(dealt(1, 8, double_pumped));
  EXPECT_FALSE(dealt(1, 8, two_copies));
  EXPECT_FALSE(dealt(1, 4, stall));
  EXPECT_TRUE(dealt(1, 8, stall));  // four nodes, two accesses
  EXPECT_TRUE(dealt(1, 16, double_pumped));
  EXPECT_TRUE(dealt(2, 4, double_pumped));
}

// More banks or longer packages are never faster; packages of whole nodes touch a node less, so
// that the lengths have the same remainder.
TEST(CriticalPath, MoreToDealIsNeverFaster) {
  using enum DirectionMemory;
  for (const std::string_view name : devices::built_in_names()) {
    for (const DirectionMemory memory : {double_pumped, two_copies, stall}) {
      const auto clock = [&](int banks, int package) {
        Architecture a;
        a.direction_banks = banks;
        a.package = package;
        a.direction_memory = memory;
        return highest_clock({devices::built_in(name), a, {}, 500});
      };
      for (const int package : {4, 7, 10, 13, 16, 64}) {
        for (int banks = 1; banks < 64; banks *= 2) {
          EXPECT_LE(clock(2 * banks, package), clock(banks, package))
              << 2 * banks << " banks on " << name;
        }
      }
      for (int banks = 1; banks <= 64; banks *= 2) {
        for (int package = 4; package < 64; package += 3) {
          EXPECT_LE(clock(banks, package + 3), clock(banks, package))
              << "packages of " << package + 3 << " on " << name;
        }
      }
    }
  }
  // Not in vain: there they limit the clock.
  Architecture a;
  a.direction_banks = 64;
  EXPECT_EQ(critical_path({thesis_device(), a, {}, 500}).paths.front().name, kWordFromBank);
}

// A rank more, and a clock more for the whole pipeline, so that no other part gives one up.
TEST(CriticalPath, ARegisterIsNeverSlower) {
  using Depth = int Architecture::*;
  for (const Depth depth : {&Architecture::memory_read_clocks, &Architecture::multiplier_clocks,
                            &Architecture::adder_tree_clocks, &Architecture::pipeline_clocks}) {
    for (const bool registered : {false, true}) {
      for (const std::string_view name : devices::built_in_names()) {
        double before = 0;
        for (int more = 0; more < 6; ++more) {
          Architecture a;
          a.absolute_value_register = registered;
          a.memory_read_clocks = a.multiplier_clocks = a.adder_tree_clocks = 1;
          a.pipeline_clocks = 6;
          a.*depth += more;
          if (depth != &Architecture::pipeline_clocks) a.pipeline_clocks += more;
          const double clock = highest_clock({devices::built_in(name), a, {}, 500});
          EXPECT_GE(clock, before) << name;
          before = clock;
        }
      }
    }
  }
  for (const std::string_view name : devices::built_in_names()) {
    Architecture with;
    with.absolute_value_register = true;
    EXPECT_GE(highest_clock({devices::built_in(name), with, {}, 500}),
              highest_clock({devices::built_in(name), {}, {}, 500}))
        << name;
  }
}

std::string limit_of(const Architecture& a, const WordLengths& w = {}) {
  return std::string(critical_path({thesis_device(), a, w, 500}).paths.front().name);
}

// What limits the clock follows what is turned.
TEST(CriticalPath, GoesWhereRegistersAreMissing) {
  Architecture a;
  a.absolute_value_register = true;
  Architecture unpipelined = a;
  unpipelined.multiplier_clocks = 1;
  EXPECT_EQ(limit_of(unpipelined), "vector word to its multiplier");
  Architecture short_tree = a;
  short_tree.adder_tree_clocks = 1;
  EXPECT_EQ(limit_of(short_tree), "accumulator of a row");
  EXPECT_EQ(limit_of(a, {.scalar_bits = 4096}), "step of a division");
  Architecture shallow = a;
  shallow.pipeline_clocks = 10;  // one rank for all that the vector unit does, and the register
  EXPECT_LT(clock_of(shallow), 0.5 * clock_of(a));
}

// A block's own limit counts, twice over where a memory is read twice a clock.
TEST(CriticalPath, BlocksHaveTheirOwnLimits) {
  Device device = thesis_device();
  device.timing->multiplier_s = 0;
  device.multipliers.front().clock_hz = 90e6;
  EXPECT_DOUBLE_EQ(highest_clock({device, {}, {}, 500}), 90e6);
  device.multipliers.front().clock_hz = 450e6;
  for (MemoryType& memory : device.memories) memory.clock_hz = 150e6;
  EXPECT_DOUBLE_EQ(highest_clock({device, {}, {}, 500}), 75e6);
  Architecture stalling;
  stalling.direction_memory = DirectionMemory::stall;
  stalling.absolute_value_register = true;
  const CriticalPath critical = critical_path({device, stalling, {}, 500});
  EXPECT_GT(critical.highest_clock_hz, 75e6);
  EXPECT_LE(critical.highest_clock_hz, 150e6);
}

TEST(RequireClock, NamesThePathAndTheHighestClock) {
  Architecture a;
  a.clock_hz = 120e6;
  try {
    require_clock({thesis_device(), a, {}, 500});
    FAIL() << "120 MHz were accepted";
  } catch (const InputError& e) {
    EXPECT_EQ(e.key(), "clock");
    EXPECT_THAT(e.what(),
                AllOf(HasSubstr("120.0 MHz is beyond what the EP2S60 reaches"),
                      HasSubstr("inner product d'(A d)"), HasSubstr("16-bit absolute value")));
  }
  a.absolute_value_register = true;
  EXPECT_NO_THROW(require_clock({thesis_device(), a, {}, 500}));
}

TEST(RequireClock, WhatItTellsCanBeSet) {
  Architecture a;
  a.clock_hz = 999e6;
  try {
    require_clock({thesis_device(), a, {}, 500});
    FAIL();
  } catch (const InputError& e) {
    const std::string told = e.what();
    const auto at = told.find("at most ") + 8;
    a.clock_hz = 1e6 * std::stod(told.substr(at));
  }
  EXPECT_NO_THROW(require_clock({thesis_device(), a, {}, 500}));
  a.clock_hz += 0.2e6;
  EXPECT_THROW(require_clock({thesis_device(), a, {}, 500}), InputError);
}

TEST(RequireClock, ADeviceWithoutDelaysRefusesNone) {
  Device device = thesis_device();
  device.timing.reset();
  Architecture a;
  a.clock_hz = 1e9;
  EXPECT_NO_THROW(require_clock({device, a, {}, 500}));
}

}  // namespace
}  // namespace hvp::accel::critical_path_test
