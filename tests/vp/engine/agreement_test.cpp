// Clocks of a solve at the three levels: the cycle-accurate engine is the measure.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/accel/cycles.h"
#include "tests/vp/engine/engine_systems.h"
#include "tests/vp/engine/levels.h"
#include "vp/fpga/engine/cycle_engine.h"
#include "vp/fpga/engine/phase_engine.h"

namespace hvp::vp::engine::agreement_test {
namespace {

using accel::Architecture;
using accel::DirectionMemory;
using fixed::Settings;

struct Variant {
  std::string name;
  std::function<void(Architecture&)> change;
};

// A chapter-5 design and what an architect turns of it, one number at a time and some together.
std::vector<Variant> variants() {
  using A = Architecture;
  return {
      {"thesis", [](A&) {}},
      {"PL1 = 1", [](A& a) { a.rows_in_parallel = 1; }},
      {"PL3 = 1", [](A& a) { a.partitions = 1; }},
      {"PL3 = 16", [](A& a) { a.partitions = 16; }},
      {"PL3 = 16, L = 1", [](A& a) { a.partitions = 16, a.nodes_per_clock = 1; }},
      {"PL2 = 4", [](A& a) { a.package = 4; }},
      {"PL2 = 16", [](A& a) { a.package = 16; }},
      {"PL2 = 24, L = 4", [](A& a) { a.package = 24, a.nodes_per_clock = 4; }},
      {"s = 12", [](A& a) { a.packages_per_row = 12; }},
      {"L = 1", [](A& a) { a.nodes_per_clock = 1; }},
      {"L = 8", [](A& a) { a.nodes_per_clock = 8; }},
      {"two copies", [](A& a) { a.direction_memory = DirectionMemory::two_copies; }},
      {"two copies, two banks",
       [](A& a) { a.direction_memory = DirectionMemory::two_copies, a.direction_banks = 2; }},
      {"stall", [](A& a) { a.direction_memory = DirectionMemory::stall; }},
      {"stall, two banks",
       [](A& a) { a.direction_memory = DirectionMemory::stall, a.direction_banks = 2; }},
      {"stall, four banks",
       [](A& a) { a.direction_memory = DirectionMemory::stall, a.direction_banks = 4; }},
      {"deep pipelines",
       [](A& a) {
         a.memory_read_clocks = 4, a.multiplier_clocks = 9, a.adder_tree_clocks = 8;
         a.pipeline_clocks = 45;
       }},
      {"shallow pipelines",
       [](A& a) {
         a.memory_read_clocks = a.multiplier_clocks = a.adder_tree_clocks = 1;
         a.pipeline_clocks = 6;
       }},
      {"register behind the absolute value", [](A& a) { a.absolute_value_register = true; }},
      {"long division", [](A& a) { a.division_clocks = 200; }},
  };
}

using test::compare;
using test::Levels;

TEST(Agreement, OverMeshesAndArchitectures) {
  const std::vector<test::NamedMatrix> meshes = test::mesh_set();
  struct Pair {
    std::string name;
    std::unique_ptr<CycleEngine> cycles;
    std::unique_ptr<PhaseEngine> phases;
  };
  std::vector<Pair> pairs;
  for (const Variant& variant : variants()) {
    Architecture a;
    variant.change(a);
    const std::string number = std::to_string(pairs.size());
    pairs.push_back({variant.name, std::make_unique<CycleEngine>(("cycles_" + number).c_str(), a),
                     std::make_unique<PhaseEngine>(("phases_" + number).c_str(), a)});
  }
  Settings settings;
  settings.iterations = 30;
  std::printf("%-24s %9s %24s %24s\n", "architecture", "clocks*", "approximately-timed, %",
              "loosely-timed, %");
  for (const Pair& pair : pairs) {
    double approximate = 0;
    double loose = 0;
    std::int64_t clocks = 0;
    for (const test::NamedMatrix& mesh : meshes) {
      SCOPED_TRACE(pair.name + ", " + mesh.name);
      const Levels levels = compare(*pair.cycles, *pair.phases, mesh.matrix, settings);
      EXPECT_EQ(levels.approximately_timed, levels.cycle_accurate);
      EXPECT_LE(std::abs(levels.loose_error()), 1.0);
      const auto keep = [](double& worst, double error) {
        if (std::abs(error) > std::abs(worst)) worst = error;
      };
      keep(approximate, levels.approximate_error());
      keep(loose, levels.loose_error());
      if (mesh.name == "sphere of 500") clocks = levels.cycle_accurate;
    }
    std::printf("%-24s %9lld %+24.2f %+24.2f\n", pair.name.c_str(), static_cast<long long>(clocks),
                approximate, loose);
  }
}

// A solve of few iterations, as a stop test ends them: what a solve takes once weighs most here.
TEST(Agreement, OfShortSolves) {
  const std::vector<test::NamedMatrix> meshes = test::mesh_set();
  CycleEngine cycles("cycles", {});
  PhaseEngine phases("phases", {});
  for (const test::NamedMatrix& mesh : meshes) {
    for (const fixed::Method method : {fixed::Method::cg, fixed::Method::jacobi_pcg}) {
      int shortest = 100;
      for (const double stop : {0.9, 0.5, 0.2, 0.1}) {
        SCOPED_TRACE(mesh.name + ", " + std::to_string(stop));
        Settings settings;
        settings.method = method;
        settings.iterations = 200;
        settings.stop_residual = stop;
        const Levels levels = compare(cycles, phases, mesh.matrix, settings);
        ASSERT_TRUE(cycles.report().reached);
        shortest = std::min(shortest, cycles.report().iterations);
        EXPECT_EQ(levels.approximately_timed, levels.cycle_accurate);
        EXPECT_LE(std::abs(levels.loose_error()), 1.0);
      }
      EXPECT_LE(shortest, 5);
    }
  }
}

struct Job {
  std::string name;
  std::function<void(Settings&)> change;
  std::int32_t rhs = 2000;
};

// What a solve can make beside its iterations.
TEST(Agreement, OverMethodsAndEndings) {
  const fixed::QuantisedMatrix matrix = fixed::quantise(test::box_stiffness(6, 6, 5), 12);
  // Not positive definite: the diagonal of one node has the wrong sign.
  fixed::QuantisedMatrix indefinite = matrix;
  for (std::size_t e = 0; e < 9; e += 4) {
    auto& entry = indefinite.value[9 * static_cast<std::size_t>(indefinite.find(100, 100)) + e];
    entry = -entry;
  }
  CycleEngine cycles("cycles", {});
  PhaseEngine phases("phases", {});
  const std::vector<Job> jobs = {
      {"jacobi-pcg", [](Settings& s) { s.method = fixed::Method::jacobi_pcg; }},
      {"block-jacobi-pcg", [](Settings& s) { s.method = fixed::Method::block_jacobi_pcg; }},
      {"128-bit scalars", [](Settings& s) { s.scalar_bits = 128; }},
      {"residual formed anew", [](Settings& s) { s.replace_residual_every = 7; }},
      {"stopped by the residual",
       [](Settings& s) {
         s.method = fixed::Method::jacobi_pcg, s.stop_residual = 0.1;
         s.iterations = 200;
       }},
      {"nothing to do", [](Settings&) {}, 0},
      {"from zero", [](Settings& s) { s.start = fixed::Start::zero; }},
      {"extrapolated", [](Settings& s) { s.start = fixed::Start::extrapolated, s.iterations = 3; }},
  };
  for (const Job& job : jobs) {
    SCOPED_TRACE(job.name);
    Settings settings;
    settings.iterations = 30;
    job.change(settings);
    const Levels levels = compare(cycles, phases, matrix, settings, job.rhs);
    EXPECT_EQ(cycles.report().reached, settings.stop_residual > 0);
    EXPECT_EQ(levels.approximately_timed, levels.cycle_accurate);
    EXPECT_LE(std::abs(levels.loose_error()), 1.0) << levels.loose_error();
  }
  Settings settings;
  const Levels broken = compare(cycles, phases, indefinite, settings, 2000);
  EXPECT_EQ(cycles.report().breakdowns, 1);
  EXPECT_EQ(broken.approximately_timed, broken.cycle_accurate);
}

// Commands that are not solves: the closed form is what the engine takes.
TEST(Agreement, OfLoadsAndNodeUpdatesIsExact) {
  const fixed::QuantisedMatrix matrix = fixed::quantise(test::box_stiffness(4, 4, 3), 12);
  const Architecture architecture;
  const accel::Pattern pattern = accel::pattern_of(matrix.row_begin);
  CycleEngine engine("engine", architecture);
  for (const fixed::Method method :
       {fixed::Method::cg, fixed::Method::jacobi_pcg, fixed::Method::block_jacobi_pcg}) {
    Settings settings;
    settings.method = method;
    engine.load(matrix, settings);
    engine.start_inversion();
    sc_core::sc_start();
    EXPECT_EQ(engine.clocks(), accel::load_cycles(architecture, pattern, settings));
    for (const int node : {0, 17, 60}) {
      const auto row = static_cast<std::size_t>(node);
      const auto first = static_cast<std::size_t>(matrix.row_begin[row]);
      const auto last = static_cast<std::size_t>(matrix.row_begin[row + 1]);
      const std::int64_t clocks = accel::node_update_cycles(
          architecture, pattern, node, std::span(matrix.column).subspan(first, last - first),
          settings);
      engine.start_constraining(node, 1000);
      sc_core::sc_start();
      EXPECT_EQ(engine.clocks(), clocks) << node;
      engine.start_restoring(node, matrix.row(node));
      sc_core::sc_start();
      EXPECT_EQ(engine.clocks(), clocks) << node;
    }
  }
}

}  // namespace
}  // namespace hvp::vp::engine::agreement_test
