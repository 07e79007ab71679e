// The logic of the engine against what yosys makes of engine.sv (tables/synthesis/measured.csv).
#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "app/devices/devices.h"
#include "models/accel/engine_logic.h"
#include "models/accel/memory.h"
#include "tables/synthesis/measured.h"

namespace hvp::accel::logic_test {
namespace {

using tables::SynthesisedBlock;
using tables::SynthesisedEngine;

std::vector<SynthesisedEngine> engines() {
  return tables::synthesised_engines(HVP_SOURCE_DIR "/tables/synthesis");
}

std::vector<LogicUse> logic_of(const SynthesisedEngine& e) {
  return logic(devices::built_in(e.architecture.device), e.architecture, e.words, e.size);
}

int used(const SynthesisedEngine& e, std::string_view type) {
  const Usage u = usage(devices::built_in(e.architecture.device), e.architecture, e.words, e.size);
  return std::ranges::find(u.resources, type, &Resource::type)->used;
}

void expect_within(double part, double model, double measured, const std::string& what) {
  EXPECT_NEAR(model, measured, part * measured) << what;
}

}  // namespace

TEST(Logic, CellsAreCountedByTheInputsOfATable) {
  // Eight products of 28 bits: four sums of 29 bits, two of 30, one of 31.
  EXPECT_EQ(adder_tree_bits(8, 28), 4 * 29 + 2 * 30 + 31);
  EXPECT_EQ(adder_tree_bits(5, 10), 2 * 11 + 12 + 13);
  EXPECT_EQ(adder_tree_bits(1, 10), 0);
  // Six inputs choose from four, four inputs from two.
  EXPECT_EQ(multiplexer_cells(4, 6), 1);
  EXPECT_EQ(multiplexer_cells(5, 6), 2);
  EXPECT_EQ(multiplexer_cells(4, 4), 3);
  EXPECT_EQ(shifter_cells(10, 6, 4), 60);
  EXPECT_EQ(shifter_cells(10, 6, 6), 30);
  EXPECT_EQ(gate_cells(4, 4), 1);
  EXPECT_EQ(gate_cells(5, 4), 2);
  EXPECT_EQ(gate_cells(1, 4), 0);
}

// What a scenario does not use does not hide: without these an agreement would say less.
TEST(Logic, EnginesThatCalibrateNothingHaveWhatTheOthersHaveNot) {
  std::set<std::string> unseen;
  bool jacobi = false;
  bool few_rows = false;
  bool many_banks = false;
  std::set<DirectionMemory> memories;
  for (const SynthesisedEngine& e : engines()) {
    if (e.calibrates) continue;
    unseen.insert(e.name);
    jacobi |= e.words.preconditioned();
    few_rows |= e.architecture.rows_in_parallel < 3;
    many_banks |= e.architecture.direction_banks > 1;
    memories.insert(e.architecture.direction_memory);
  }
  EXPECT_GE(unseen.size(), 3U);
  EXPECT_TRUE(jacobi && few_rows && many_banks);
  EXPECT_GE(memories.size(), 2U);
}

// The goal of docs/synthesis.md; registers are counted one by one.
TEST(Logic, IsThatOfEnginesThatItHasNotSeen) {
  for (const SynthesisedEngine& e : engines()) {
    if (e.calibrates) continue;
    const SynthesisedBlock& whole = e.whole();
    expect_within(0.15, used(e, "logic"), whole.cells, e.name + ": look-up tables");
    expect_within(0.03, used(e, "registers"), whole.registers, e.name + ": registers");
    expect_within(0.15, used(e, "EBR"), whole.memories, e.name + ": memory blocks");
    expect_within(0.15, used(e, "multipliers"), whole.multipliers, e.name + ": multipliers");
  }
}

TEST(Logic, RegistersOfEachUnitAreThoseOfItsSources) {
  int compared = 0;
  for (const SynthesisedEngine& e : engines()) {
    for (const LogicUse& use : logic_of(e)) {
      const SynthesisedBlock* block = e.block(use.unit);
      // What these have is spread over blocks of other names.
      if (block == nullptr || use.unit == "sequencer" || use.unit == "partition") continue;
      EXPECT_EQ(use.count, block->count) << e.name << ": " << use.unit;
      expect_within(0.05, static_cast<double>(use.counted.registers), block->registers,
                    e.name + ": " + std::string(use.unit));
      ++compared;
    }
  }
  EXPECT_GE(compared, 8 * 8);
}

TEST(Logic, CoefficientsAreThoseOfTheCalibratingEngines) {
  const std::vector<SynthesisedEngine> all = engines();
  std::set<std::string_view> units;
  for (const SynthesisedEngine& e : all) {
    if (!e.calibrates) continue;
    for (const LogicUse& use : logic_of(e)) {
      if (!units.insert(use.unit).second) continue;
      EXPECT_NEAR(use.coefficient, tables::fitted_coefficient(all, use.unit), 0.0101) << use.unit;
    }
  }
  EXPECT_EQ(units.size(), 13U);
}

// Table 6.2: 8.4 k ALUTs and 10.5 k registers, which give Stratix II its shares of the count.
TEST(Logic, IsThesisTable62OnItsDevice) {
  const Pattern mesh{std::vector<int>(500, 13)};
  const Usage u = usage(devices::built_in("EP2S60"), {}, {}, mesh);
  const auto of = [&u](std::string_view type) {
    return std::ranges::find(u.resources, type, &Resource::type)->used;
  };
  EXPECT_NEAR(of("logic"), 8400, 8400 / 50.0);
  EXPECT_NEAR(of("registers"), 10500, 10500 / 50.0);
  EXPECT_TRUE(u.fits());
}

TEST(Logic, GrowsWithWhatTheEngineHas) {
  const SystemSize size{500, 500, 512, 13};
  const Device& device = devices::built_in("LFE5U-85F");
  const auto registers = [&](const Architecture& a, const WordLengths& w) {
    return logic_of_device(device, logic(device, a, w, size)).registers;
  };
  const std::int64_t thesis = registers({}, {});
  Architecture a;
  a.partitions = 10;
  EXPECT_GT(registers(a, {}), thesis);
  a = {};
  a.nodes_per_clock = 4;
  EXPECT_GT(registers(a, {}), thesis);
  a = {};
  a.pipeline_clocks = 30;
  EXPECT_GT(registers(a, {}), thesis);
  a = {};
  a.package = 16;
  EXPECT_GT(registers(a, {}), thesis);
  EXPECT_GT(registers({}, {.vector_bits = 20}), thesis);
  const std::int64_t jacobi = registers({}, {.method = fixed::Method::jacobi_pcg});
  EXPECT_GT(jacobi, thesis);
  EXPECT_GT(registers({}, {.method = fixed::Method::block_jacobi_pcg}), jacobi);
}

}  // namespace hvp::accel::logic_test
