#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/draw/colour_map.h"
#include "app/draw/deformation_step.h"
#include "app/draw/plot_data.h"
#include "app/draw/run_files.h"
#include "app/draw/view.h"
#include "app/results/vtu_files.h"
#include "tests/app/sample_run.h"
#include "tests/app/scratch_directory.h"

namespace hvp::draw::draw_data_test {
namespace {

using Eigen::Vector3d;

TEST(AxisTicks, AreRoundAndInside) {
  const Ticks ticks = round_ticks(0.0, 2240.0, 6);
  EXPECT_EQ(ticks.labels, (std::vector<std::string>{"0", "500", "1000", "1500", "2000"}));
  const Ticks small = round_ticks(0.0, 0.0123, 6);
  EXPECT_EQ(small.labels.front(), "0.000");
  EXPECT_EQ(small.labels.back(), "0.010");
}

TEST(AxisTicks, EveryStepIsOneTwoOrFiveTimesAPowerOfTen) {
  for (double high = 1.1e-6; high < 1e9; high *= 1.37) {
    const Ticks ticks = round_ticks(0.0, high, 6);
    EXPECT_GE(ticks.values.size(), 3u) << high;
    EXPECT_LE(ticks.values.size(), 7u) << high;
    EXPECT_EQ(ticks.values.front(), 0.0);
    EXPECT_LE(ticks.values.back(), high * (1.0 + 1e-9));
    const double digit = ticks.step / std::pow(10.0, std::floor(std::log10(ticks.step) + 1e-9));
    EXPECT_TRUE(std::abs(digit - 1) < 1e-9 || std::abs(digit - 2) < 1e-9 ||
                std::abs(digit - 5) < 1e-9)
        << ticks.step;
    for (std::size_t i = 1; i < ticks.labels.size(); ++i)
      EXPECT_NE(ticks.labels[i], ticks.labels[i - 1]) << "labels tell the ticks apart";
  }
}

TEST(AxisTicks, FramesAreNotSplit) {
  EXPECT_EQ(whole_ticks(-0.5, 2.5, 10).labels, (std::vector<std::string>{"0", "1", "2"}));
}

TEST(FourDigits, RoundsAndDropsTrailingZeros) {
  EXPECT_EQ(four_digits(0.0), "0");
  EXPECT_EQ(four_digits(2000.0), "2000");
  EXPECT_EQ(four_digits(123456.0), "123456");
  EXPECT_EQ(four_digits(862.849), "862.8");
  EXPECT_EQ(four_digits(1.2), "1.2");
  EXPECT_EQ(four_digits(-0.0012345), "-0.001234");
  EXPECT_EQ(four_digits(1.5e-7), "1.500e-07");
}

// The CIELAB coordinates of sRGB red (D65), as printed in textbooks: 53.24, 80.09, 67.20.
TEST(ColourMap, LabOfRedAndWhite) {
  const auto red = lab_of({255, 0, 0});
  EXPECT_NEAR(red[0], 53.24, 0.01);
  EXPECT_NEAR(red[1], 80.09, 0.02);
  EXPECT_NEAR(red[2], 67.20, 0.02);
  const auto white = lab_of({255, 255, 255});
  EXPECT_NEAR(white[0], 100.0, 0.01);
  EXPECT_NEAR(white[1], 0.0, 0.02);
  EXPECT_NEAR(white[2], 0.0, 0.02);
}

// Measured over 16 steps, so that rounding to bytes does not count.
TEST(ColourMap, EqualStepsLookEqual) {
  constexpr int kSteps = 16;
  std::vector<double> distance;
  for (int i = 0; i < kSteps; ++i) {
    const auto a = lab_of(sequential_colour(i / double(kSteps)));
    const auto b = lab_of(sequential_colour((i + 1) / double(kSteps)));
    EXPECT_NEAR(a[0] - b[0], (91.0 - 22.0) / kSteps, 0.6) << "lightness falls evenly, step " << i;
    distance.push_back(std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]));
  }
  const auto [least, most] = std::minmax_element(distance.begin(), distance.end());
  EXPECT_LT(*most / *least, 1.2);
}

TEST(ColourMap, ClampsOutsideZeroToOne) {
  EXPECT_EQ(sequential_colour(-1.0), sequential_colour(0.0));
  EXPECT_EQ(sequential_colour(2.0), sequential_colour(1.0));
}

// Euler: a closed surface without handles has V − E + F = 2 and 3F = 2E.
TEST(Surface, OfABallIsClosedAndPointsOutwards) {
  const mesh::TetMesh ball = sample::ball(0.05, 4);
  const auto faces = outer_faces(ball.tetrahedra);
  const auto edges = edges_of(faces);
  std::vector<int> nodes;
  for (const auto& face : faces) nodes.insert(nodes.end(), face.begin(), face.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  EXPECT_EQ(faces.size(), 6u * 4 * 4 * 2);
  EXPECT_EQ(3 * faces.size(), 2 * edges.size());
  EXPECT_EQ(nodes.size() + faces.size(), edges.size() + 2);
  for (const auto& face : faces) {
    const auto at = [&](std::size_t c) { return ball.nodes[static_cast<std::size_t>(face[c])]; };
    EXPECT_GT((at(1) - at(0)).cross(at(2) - at(0)).dot(at(0) + at(1) + at(2)), 0.0);
  }
}

// Every node of a closed outline has an even number of outline edges.
TEST(Surface, OutlineOfABallIsAClosedLineAtItsRim) {
  const mesh::TetMesh ball = sample::ball(1.0, 8);
  const auto faces = outer_faces(ball.tetrahedra);
  const Vector3d towards = Vector3d(0.3, -1.0, 0.2).normalized();
  const auto lines = outline(ball.nodes, faces, edges_of(faces), towards);
  ASSERT_FALSE(lines.empty());
  std::vector<int> degree(ball.nodes.size(), 0);
  for (const auto& line : lines)
    for (const int node : line) {
      ++degree[static_cast<std::size_t>(node)];
      EXPECT_LT(std::abs(ball.nodes[static_cast<std::size_t>(node)].dot(towards)), 0.3);
    }
  for (const int d : degree) EXPECT_EQ(d % 2, 0);
}

TEST(Surface, HidesWhatLiesBehindIt) {
  const mesh::TetMesh ball = sample::ball(1.0, 4);
  const auto faces = outer_faces(ball.tetrahedra);
  const Vector3d towards = Vector3d(0.3, -1.0, 0.2).normalized();
  EXPECT_TRUE(hidden(ball.nodes, faces, -1.5 * towards, towards)) << "behind";
  EXPECT_TRUE(hidden(ball.nodes, faces, Vector3d(0.01, 0.02, 0.03), towards)) << "inside";
  EXPECT_FALSE(hidden(ball.nodes, faces, 1.5 * towards, towards)) << "in front";
  EXPECT_FALSE(hidden(ball.nodes, faces, Vector3d(0.0, 0.0, 2.0), towards)) << "beside";
}

DeformationStep pressed_ball(const Vector3d& anchored_side, const Vector3d& dent) {
  DeformationStep step;
  const mesh::TetMesh ball = sample::ball(0.05, 4);
  step.rest = ball.nodes;
  step.displacement.assign(ball.nodes.size(), Vector3d::Zero());
  step.tetrahedra = ball.tetrahedra;
  std::size_t contact = 0;
  for (std::size_t i = 0; i < ball.nodes.size(); ++i) {
    if (ball.nodes[i].dot(anchored_side) > 0.035) step.anchors.push_back(static_cast<int>(i));
    if (ball.nodes[i].dot(dent) < ball.nodes[contact].dot(dent)) contact = i;
  }
  step.contact_node = static_cast<int>(contact);
  step.displacement[contact] = 0.01 * dent;
  return step;
}

void expect_frame(const View& view) {
  EXPECT_NEAR(view.right.norm(), 1.0, 1e-12);
  EXPECT_NEAR(view.up.norm(), 1.0, 1e-12);
  EXPECT_NEAR((view.right.cross(view.up) - view.towards_viewer).norm(), 0.0, 1e-12);
}

TEST(View, PressedFromAboveIsSeenInProfileAndALittleFromAbove) {
  const View view = choose_view(pressed_ball(-Vector3d::UnitZ(), -Vector3d::UnitZ()));
  expect_frame(view);
  EXPECT_NEAR(view.right.z(), 0.0, 1e-12) << "the picture does not lean";
  EXPECT_GT(view.towards_viewer.z(), 0.2);
  EXPECT_LT(view.towards_viewer.z(), 0.4);
}

TEST(View, AnchorsAreAtTheBottomOfThePicture) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      const Vector3d anchored = sign * Vector3d::Unit(axis);
      const View view = choose_view(pressed_ball(anchored, anchored));
      expect_frame(view);
      EXPECT_LT(anchored.dot(view.up), -0.9);
      EXPECT_NEAR(anchored.dot(view.right), 0.0, 1e-12);
    }
}

TEST(View, ADentInASideIsSeenNearlyInProfileAndNotFromBehind) {
  for (const Vector3d& dent : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(-1, 1, 0)}) {
    const View view = choose_view(pressed_ball(-Vector3d::UnitZ(), dent.normalized()));
    expect_frame(view);
    const double along = dent.normalized().dot(view.towards_viewer);
    EXPECT_LT(along, -0.2);
    EXPECT_GT(along, -0.5);
  }
}

// A crater with steep walls and a small probe at its bottom.
TEST(View, RisesUntilTheProbeIsNotHidden) {
  DeformationStep step = pressed_ball(-Vector3d::UnitZ(), -Vector3d::UnitZ());
  const auto contact = static_cast<std::size_t>(step.contact_node);
  step.displacement[contact] = {0.0, 0.0, -0.02};
  step.probe_radius = 0.002;
  step.probe = step.rest[contact] + step.displacement[contact] + Vector3d(0.0, 0.0, 0.002);
  const View view = choose_view(step);
  expect_frame(view);
  EXPECT_GT(view.towards_viewer.z(), 0.4);
  EXPECT_LE(view.towards_viewer.z(), std::sin(60.0 * 3.15 / 180.0));
  std::vector<Vector3d> deformed = step.rest;
  for (std::size_t i = 0; i < deformed.size(); ++i) deformed[i] += step.displacement[i];
  EXPECT_FALSE(hidden(deformed, outer_faces(step.tetrahedra),
                      step.probe + 0.9 * step.probe_radius * view.towards_viewer,
                      view.towards_viewer));
}

TEST(View, WithoutAnchorsAndContactUpIsZ) {
  DeformationStep step = pressed_ball(Vector3d::Zero(), -Vector3d::UnitZ());
  step.contact_node = -1;
  std::fill(step.displacement.begin(), step.displacement.end(), Vector3d::Zero());
  const View view = choose_view(step);
  expect_frame(view);
  EXPECT_GT(view.up.z(), 0.9);
}

// The sample's steps are of frames 0, 50, 100 and 150; it presses most at 100.
TEST(Step, IsTheOneWithTheLargestForce) {
  const ScratchDirectory scratch;
  sample::write_run(scratch.path(), {.frames = 200, .step_every = 50, .cells = 2});
  const DeformationStep step = read_deepest_step(scratch.path());
  EXPECT_EQ(step.frame, 100);
  EXPECT_DOUBLE_EQ(step.time_s, 0.2);
  EXPECT_GE(step.contact_node, 0);
  EXPECT_NEAR(step.force_N.z(), 1.2, 1e-12);
  EXPECT_EQ(step.anchors, sample::lowest_nodes(sample::ball(0.05, 2), 0.1));
  EXPECT_EQ(step.tetrahedra, sample::ball(0.05, 2).tetrahedra);
}

// A proxy stands on the surface, and is drawn there.
TEST(Step, HasEachProbeWhereItsProxyIs) {
  const ScratchDirectory directory;
  const mesh::TetMesh mesh = sample::ball(0.05, 2);
  const std::vector<double> none(6 * mesh.tetrahedra.size());
  const std::vector<double> still(3 * mesh.nodes.size());
  const std::vector<Eigen::Vector3d> proxies = {{0.01, -0.02, 0.055}, {0.02, 0.01, 0.05}};
  const std::vector<Eigen::Vector3d> tips = {{0.02, 0.01, 0.045}};
  const std::vector<Eigen::Vector3d> forces = {{0, 0, 0.5}};
  results::StepInfo info;
  info.probe_position_m = {0.01, -0.02, 0.05};
  info.further_probes_m = tips;
  info.further_forces_N = forces;
  info.strain = info.stress_Pa = none;
  info.von_mises_Pa = {none.data(), mesh.tetrahedra.size()};
  results::DeformationWriter writer(directory.path(), mesh, {});
  writer.write(0.002, 1, still, info);
  info.proxies_m = proxies;
  writer.write(0.004, 2, still, info);
  const DeformationStep node = read_step(directory.path() / "deformation_000001.vtu");
  EXPECT_EQ(node.probe, info.probe_position_m);
  EXPECT_EQ(node.tip, node.probe);
  const DeformationStep step = read_step(directory.path() / "deformation_000002.vtu");
  EXPECT_EQ(step.probe, proxies[0]);
  EXPECT_EQ(step.tip, info.probe_position_m);
  ASSERT_EQ(step.further_probes.size(), 1u);
  EXPECT_EQ(step.further_probes[0].place, proxies[1]);
  EXPECT_EQ(step.further_probes[0].tip, tips[0]);
}

TEST(Step, IsTheLastOneWhereNothingIsTouched) {
  const ScratchDirectory scratch;
  sample::write_run(scratch.path(), {.frames = 40, .step_every = 2, .cells = 2});
  // The list's first two steps, of frames 0 and 2: the probe comes down at frame 5.
  std::ofstream(scratch.path() / "deformation.pvd")
      << "<VTKFile><Collection><DataSet file=\"deformation_000000.vtu\"/>"
         "<DataSet file=\"deformation_000002.vtu\"/></Collection></VTKFile>";
  const DeformationStep step = read_deepest_step(scratch.path());
  EXPECT_EQ(step.frame, 2);
  EXPECT_EQ(step.contact_node, -1);
}

std::size_t frames_in(const LatencyBins& bins) {
  std::size_t frames = 0;
  for (const LatencyBins::Bin& bin : bins.bins) frames += bin.frames;
  return frames;
}

// Every latency lies in one bin, in order and apart, and no bin is on both sides of the budget.
void expect_sound(const LatencyBins& bins, const std::vector<double>& latencies, double budget_us) {
  EXPECT_EQ(frames_in(bins), latencies.size());
  double before = -1e300;
  for (const LatencyBins::Bin& bin : bins.bins) {
    EXPECT_GE(bin.from, before - 1e-9);
    EXPECT_NEAR(bin.to - bin.from, bins.width, 1e-9 * bin.to);
    EXPECT_TRUE(bin.late ? bin.from >= budget_us : bin.to <= budget_us) << bin.from;
    EXPECT_EQ(bin.frames, static_cast<std::size_t>(std::count_if(
                              latencies.begin(), latencies.end(),
                              [&](double us) { return us > bin.from && us <= bin.to; })));
    EXPECT_LE(bin.frames, bins.fullest);
    before = bin.to;
  }
}

TEST(LatencyBins, HoldEveryLatencyOnItsSideOfTheBudget) {
  std::vector<double> latencies;
  for (int i = 0; i < 1000; ++i) latencies.push_back(1500.0 + 1.0 * i);  // 500 late by 0 to 499
  for (const double budget : {10.0, 1234.5, 1999.0, 2000.0, 2000.5, 9000.0}) {
    SCOPED_TRACE(budget);
    for (const int wanted : {5, 50}) {
      const LatencyBins bins = latency_bins(latencies, budget, wanted);
      expect_sound(bins, latencies, budget);
      EXPECT_LE(bins.bins.size(), static_cast<std::size_t>(2 * wanted));
    }
  }
}

TEST(LatencyBins, AForceThatIsDueNowIsInTime) {
  const LatencyBins bins = latency_bins({1999.0, 2000.0, 2000.001}, 2000.0, 50);
  std::size_t late = 0;
  for (const LatencyBins::Bin& bin : bins.bins) late += bin.late ? bin.frames : 0;
  EXPECT_EQ(late, 1U);
}

// Percentiles by nearest rank.
TEST(LatencyBins, SoManyPerCentDoNotExceedThePercentiles) {
  std::vector<double> latencies;
  for (int i = 200; i > 0; --i) latencies.push_back(i);
  const LatencyBins bins = latency_bins(latencies, 500.0, 50);
  EXPECT_EQ(bins.p50, 100.0);
  EXPECT_EQ(bins.p99, 198.0);
}

TEST(LatencyBins, OneLatencyIsOneBin) {
  for (const double us : {842.0, 2000.0, 2300.0}) {
    SCOPED_TRACE(us);
    const std::vector<double> latencies(40, us);
    const LatencyBins bins = latency_bins(latencies, 2000.0, 50);
    ASSERT_EQ(bins.bins.size(), 1U);
    EXPECT_EQ(bins.fullest, 40U);
    EXPECT_EQ(bins.p50, us);
    EXPECT_EQ(bins.p99, us);
    expect_sound(bins, latencies, 2000.0);
  }
}

TEST(LatencyBins, WithoutAFrameThereAreNone) {
  EXPECT_TRUE(latency_bins({}, 2000.0, 50).bins.empty());
}

std::vector<Contribution> many() {
  return {{"a", "x", 500.0}, {"b", "x", 100.0}, {"a", "x", 300.0}, {"c", "x", 60.0},
          {"d", "x", 30.0},  {"e", "x", 6.0},   {"f", "x", 4.0}};
}

double sum_of(const std::vector<Contribution>& rows) {
  return std::accumulate(rows.begin(), rows.end(), 0.0,
                         [](double sum, const Contribution& row) { return sum + row.us; });
}

TEST(Contributions, AreAddedUpByNameSortedAndSmallOnesGrouped) {
  const auto rows = largest_contributions(many(), 0.01, 10);
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[0].part, "a");
  EXPECT_EQ(rows[0].us, 800.0);
  EXPECT_EQ(rows[3].part, "d");
  EXPECT_EQ(rows[4].part, "other");
  EXPECT_EQ(rows[4].phase, "2 phases");
  EXPECT_EQ(rows[4].us, 10.0);
}

TEST(Contributions, NeverMoreThanAskedForAndNothingIsLost) {
  for (std::size_t most = 2; most < 9; ++most)
    for (const double share : {0.0, 0.005, 0.01, 0.5}) {
      const auto rows = largest_contributions(many(), share, most);
      EXPECT_LE(rows.size(), most);
      EXPECT_DOUBLE_EQ(sum_of(rows), 1000.0);
    }
}

TEST(Contributions, WhatTookNoTimeIsNotCounted) {
  auto all = many();
  all.push_back({"host", "release", 0.0});
  const auto rows = largest_contributions(all, 0.01, 10);
  EXPECT_EQ(rows.back().phase, "2 phases");
}

TEST(Contributions, ASingleSmallOneKeepsItsName) {
  const auto rows = largest_contributions({{"a", "x", 99.5}, {"b", "y", 0.5}}, 0.01, 10);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1].part, "b");
}

}  // namespace
}  // namespace hvp::draw::draw_data_test
