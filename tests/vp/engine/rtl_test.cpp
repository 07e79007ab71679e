// spmxv.sv beside the engine's own sub-blocks, at every clock of solves on every mesh of the set.
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/vp/engine/engine_systems.h"
#include "vp/fpga/rtl/rtl_spmxv.h"

namespace hvp::vp::rtl::rtl_test {
namespace {

void solve_beside(engine::CycleEngine& engine, std::vector<std::unique_ptr<RtlSpmxv>>& rtl,
                  const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) {
  engine.load(matrix, settings);
  for (const auto& block : rtl) block->load();
  // Large enough that the longest words of d appear.
  engine.write_b(test::random_words(matrix.rows(), 30000, 11));
  engine.write_x(test::random_words(matrix.rows(), 2000, 12));
  engine.start_solve(settings);
  sc_core::sc_start();
  ASSERT_TRUE(engine.idle());
}

TEST(Rtl, AgreesClockForClockAndBitForBitOnEveryMesh) {
  const std::vector<test::NamedMatrix> meshes = test::mesh_set();
  engine::CycleEngine engine("engine", {});
  std::vector<std::unique_ptr<RtlSpmxv>> rtl;
  for (int i = 0; i < engine.architecture().partitions; ++i) {
    rtl.push_back(std::make_unique<RtlSpmxv>(("rtl_" + std::to_string(i)).c_str(), engine, i));
  }
  fixed::Settings settings;
  settings.iterations = 3;
  for (const test::NamedMatrix& mesh : meshes) {
    SCOPED_TRACE(mesh.name);
    std::int64_t rows = 0;
    for (const auto& block : rtl) rows -= block->rows();
    solve_beside(engine, rtl, mesh.matrix, settings);
    for (const auto& block : rtl) {
      EXPECT_EQ(block->difference(), "") << block->name();
      rows += block->rows();
    }
    // A product of the set-up and one an iteration, every row of each compared.
    EXPECT_EQ(rows, 4 * mesh.matrix.block_rows());
    EXPECT_GT(rtl.front()->edges(), 0);
  }
}

// One lane and many short rows: the result memory fills, and packages wait for room.
TEST(Rtl, AgreesWhereTheResultMemoryIsFull) {
  const fixed::QuantisedMatrix matrix = fixed::quantise(test::box_stiffness(140, 1, 1), 12);
  accel::Architecture architecture;
  architecture.nodes_per_clock = 1;
  architecture.partitions = 16;
  engine::CycleEngine engine("engine", architecture);
  std::vector<std::unique_ptr<RtlSpmxv>> rtl;
  for (int i = 0; i < architecture.partitions; ++i) {
    rtl.push_back(std::make_unique<RtlSpmxv>(("rtl_" + std::to_string(i)).c_str(), engine, i));
  }
  fixed::Settings settings;
  settings.iterations = 5;
  solve_beside(engine, rtl, matrix, settings);
  for (const auto& block : rtl) EXPECT_EQ(block->difference(), "") << block->name();
  EXPECT_GT(engine.block(0).queue_stalls(), 0);
}

// The comparison itself: a word that only the engine's memory has is seen.
TEST(Rtl, ADifferentWordIsFound) {
  const fixed::QuantisedMatrix matrix = fixed::quantise(test::box_stiffness(3, 3, 3), 12);
  engine::CycleEngine engine("engine", {});
  RtlSpmxv rtl("rtl", engine, 0);
  fixed::Settings settings;
  settings.iterations = 2;
  engine.load(matrix, settings);
  rtl.load();
  const int node = engine.layout().partitions().front().row.front();
  engine.start_constraining(node, 1000);
  sc_core::sc_start();
  EXPECT_EQ(rtl.difference(), "");
  engine.write_b(test::random_words(matrix.rows(), 3000, 11));
  engine.write_x(test::random_words(matrix.rows(), 2000, 12));
  engine.start_solve(settings);
  sc_core::sc_start();
  EXPECT_NE(rtl.difference().find("result_sum is"), std::string::npos) << rtl.difference();
}

TEST(Rtl, IsForTheThesisSubBlockOnly) {
  accel::Architecture wide;
  wide.package = 16;
  engine::CycleEngine engine("engine", wide);
  try {
    const RtlSpmxv rtl("rtl", engine, 0);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(e.key(), "package");
  }
}

}  // namespace
}  // namespace hvp::vp::rtl::rtl_test
