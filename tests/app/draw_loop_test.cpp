#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/draw/plot_data.h"
#include "app/draw/run_files.h"
#include "app/draw/series_files.h"
#include "models/config/input_error.h"
#include "tests/app/sample_loop.h"
#include "tests/app/sample_run.h"
#include "tests/app/scratch_directory.h"

namespace hvp::draw::draw_loop_test {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

TEST(Units, AreThePreferredOneWhereThatIsReadable) {
  EXPECT_EQ(unit_for(0.02, "m", 1e-3).name, "mm");
  EXPECT_DOUBLE_EQ(unit_for(0.02, "m", 1e-3).size, 1e-3);
  EXPECT_EQ(unit_for(0.0, "J", 1e-3).name, "mJ");
  EXPECT_EQ(unit_for(0.01, "N", 1.0).name, "N");
  EXPECT_EQ(unit_for(9999.0, "N", 1.0).name, "N");
}

TEST(Units, FollowTheSizeOtherwise) {
  EXPECT_EQ(unit_for(18.2, "J", 1e-3).name, "J");
  EXPECT_EQ(unit_for(2e-9, "J", 1e-3).name, "nJ");
  EXPECT_EQ(unit_for(2e4, "N", 1.0).name, "kN");
  for (double largest = 1.1e-30; largest < 1e60; largest *= 7.3) {
    const double shown = largest / unit_for(largest, "N", 1.0).size;
    EXPECT_GE(shown, 0.01) << largest;
    EXPECT_LT(shown, 1e4) << largest;
  }
  EXPECT_EQ(unit_for(2e30, "N", 1.0).name, "1e30 N");
}

// Up in one frame and down in the next: in every column of the picture both are to be seen.
TEST(Strokes, KeepWhatSwingsWithinAColumn) {
  constexpr int kSamples = 100000;
  constexpr int kColumns = 1000;
  std::vector<double> x;
  std::vector<double> y;
  for (int i = 0; i < kSamples; ++i) {
    x.push_back(i);
    y.push_back(i % 2 == 0 ? 1.0 : -1.0);
  }
  y[54321] = 7.0;
  const auto lines = strokes(x, y, 0.0, kSamples, kColumns);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_LE(lines.front().size(), std::size_t{4 * kColumns});
  std::vector<double> low(kColumns, 9.0);
  std::vector<double> high(kColumns, -9.0);
  for (std::size_t i = 0; i < lines.front().size(); ++i) {
    const Eigen::Vector2d& p = lines.front()[i];
    constexpr double kSamplesAColumn = static_cast<double>(kSamples) / kColumns;
    const auto column = static_cast<std::size_t>(p.x() / kSamplesAColumn);
    low[column] = std::min(low[column], p.y());
    high[column] = std::max(high[column], p.y());
    EXPECT_LT(i == 0 ? -1.0 : lines.front()[i - 1].x(), p.x());
  }
  for (std::size_t column = 0; column < kColumns; ++column) {
    EXPECT_EQ(low[column], -1.0);
    EXPECT_EQ(high[column], column == 543 ? 7.0 : 1.0);
  }
}

TEST(Strokes, AreTheSamplesWhereThoseAreFewAndEndWhereThereIsNone) {
  const std::vector<double> x = {0, 1, 2, 3, 4, 5};
  const std::vector<double> y = {3, 1, kNothing, 2, 5, std::numeric_limits<double>::infinity()};
  const auto lines = strokes(x, y, 0.0, 5.0, 1000);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0], (std::vector<Eigen::Vector2d>{{0, 3}, {1, 1}}));
  EXPECT_EQ(lines[1], (std::vector<Eigen::Vector2d>{{3, 2}, {4, 5}}));
  EXPECT_TRUE(strokes(x, std::vector<double>(6, kNothing), 0.0, 5.0, 10).empty());
}

TEST(Stretches, LastUntilTheNextSampleAndJoinAcrossSmallGaps) {
  const std::vector<double> x = {0, 1, 2, 3, 4, 5, 6, 7};
  const std::vector<double> y = {0, -1, -1, 0, -1, kNothing, 0, -1};
  auto below = stretches_below(x, y, -0.5, 0.1);
  ASSERT_EQ(below.size(), 3U);
  EXPECT_EQ(below[0].from, 1.0);
  EXPECT_EQ(below[0].to, 3.0);
  EXPECT_EQ(below[1].from, 4.0);
  EXPECT_EQ(below[1].to, 5.0);
  EXPECT_EQ(below[2].from, 7.0);
  below = stretches_below(x, y, -0.5, 1.5);
  ASSERT_EQ(below.size(), 2U);
  EXPECT_EQ(below[0].to, 5.0);
}

class LoopTest : public testing::Test {
 protected:
  LoopTest() { sample::write_run(scratch_.path(), {.frames = 40, .step_every = 20, .cells = 2}); }
  std::optional<LoopSeries> read() const { return read_loop(scratch_.path() / "frames.csv"); }
  ScratchDirectory scratch_;
};

TEST_F(LoopTest, ARunWithoutItsColumnsHasNone) { EXPECT_FALSE(read()); }

TEST_F(LoopTest, ReadsEveryProbe) {
  sample::add_loop(scratch_.path(), {.probes = 3, .swing_N = 0.5, .absorbed_J = -0.04});
  const auto loop = read();
  ASSERT_TRUE(loop);
  ASSERT_EQ(loop->probes.size(), 3U);
  ASSERT_EQ(loop->time_s.size(), 40U);
  EXPECT_DOUBLE_EQ(loop->time_s[10], 0.02);
  const ProbeSeries& first = loop->probes[0];
  EXPECT_DOUBLE_EQ(first.tip_m[2][10], 0.02 * std::sin(1.5));
  EXPECT_DOUBLE_EQ(loop->probes[2].tip_m[2][10], 0.02 * std::sin(1.5) + 0.01);
  EXPECT_NEAR(first.intended_m[2][10], first.tip_m[2][10] - 0.001, 1e-15);
  EXPECT_EQ(first.motor_N[2][10], 1.5);
  EXPECT_EQ(first.motor_N[2][11], 0.5);
  EXPECT_EQ(first.hand_N[2][10], -1.0);
  EXPECT_DOUBLE_EQ(first.stored_J[10], 0.00025);
  EXPECT_DOUBLE_EQ(first.port_J[10], -0.01);
  EXPECT_EQ(main_axis(first), 2U);
}

TEST_F(LoopTest, WithoutAHandNothingIsIntended) {
  sample::add_loop(scratch_.path(), {.held = false});
  const auto loop = read();
  ASSERT_TRUE(loop);
  for (const auto& axis : loop->probes[0].intended_m)
    for (const double value : axis) EXPECT_TRUE(std::isnan(value));
  EXPECT_EQ(main_axis(loop->probes[0]), 2U);
}

// The device stands still against a wall while the hand pushes along x.
TEST(MainAxis, IsTheHandsWhereThatMovesMore) {
  ProbeSeries probe;
  probe.tip_m = {std::vector<double>{0, 0}, {0, 0.001}, {0, 0}};
  probe.intended_m = {std::vector<double>{0, 0.01}, {0, kNothing}, {0, 0}};
  EXPECT_EQ(main_axis(probe), 0U);
}

TEST(StabilityMap, IsReadWithItsTitleOrWithout) {
  const ScratchDirectory scratch;
  const auto path = scratch.path() / "map.csv";
  const std::string table =
      "damping_N_s_m,stiffness_max_N_m,stiffness_linear_N_m,stiffness_passive_N_m\n"
      "0,100,110,-5\n0.5,200.5,210,20\n";
  std::ofstream(path) << table;
  StabilityMap map = read_stability_map(path);
  EXPECT_EQ(map.title, "");
  EXPECT_EQ(map.damping_N_s_m, (std::vector<double>{0.0, 0.5}));
  EXPECT_EQ(map.runs_N_m, (std::vector<double>{100.0, 200.5}));
  EXPECT_EQ(map.linear_N_m, (std::vector<double>{110.0, 210.0}));
  EXPECT_EQ(map.passive_N_m, (std::vector<double>{-5.0, 20.0}));
  std::ofstream(path) << "# a wall, 1 kHz\n" << table;
  map = read_stability_map(path);
  EXPECT_EQ(map.title, "a wall, 1 kHz");
  EXPECT_EQ(map.runs_N_m.size(), 2U);
}

TEST(FitSeries, RowsOfEmptyFieldsPartTwoStretches) {
  const ScratchDirectory scratch;
  const auto path = scratch.path() / "fit.csv";
  std::ofstream(path) << "# a device\nx,observed,modelled,residual\n0,1,2,-1\n,,,\n1,3,3,0\n";
  const FitSeries series = read_fit(path);
  EXPECT_EQ(series.title, "a device");
  EXPECT_EQ(series.x, (std::vector<double>{0, 0, 1}));
  EXPECT_EQ(series.observed[2], 3);
  EXPECT_TRUE(std::isnan(series.modelled[1]));
  EXPECT_EQ(series.residual[0], -1);
  for (const char* rows : {"", ",,,\n", "1,1,1,0\n0,1,1,0\n", "0,1,1\n", "0,x,1,1\n"}) {
    std::ofstream(path) << "x,observed,modelled,residual\n" << rows;
    EXPECT_THROW(read_fit(path), InputError) << rows;
  }
}

}  // namespace
}  // namespace hvp::draw::draw_loop_test
