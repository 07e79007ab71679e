// The engine in SystemVerilog in the thesis' size, its refusals, and that a difference to the
// cycle-accurate one is found.
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/vp/engine/random_systems.h"
#include "tests/vp/engine/rtl_pair.h"

namespace hvp::vp::rtl::rtl_host_test {
namespace {

using fixed::Settings;
using test::Pair;
using test::Random;
using test::settings_of;
using test::words;

// The thesis' own size: its sphere, all its iterations.
void solve_the_sphere(fixed::Method method) {
  const fixed::QuantisedMatrix matrix = fixed::quantise(hvp::test::sphere_stiffness(500), 12);
  Pair pair(kEngineThesis);
  Random random(4);
  Settings settings = settings_of(kEngineThesis);
  settings.method = method;
  pair.load(matrix, settings);
  for (int job = 0; job < 2; ++job) {
    pair.write_b(hvp::test::random_words(matrix.rows(), 30000, random.bits()));
    pair.solve(settings);
    if (testing::Test::HasFatalFailure()) return;
  }
  EXPECT_EQ(pair.iterations, 2 * settings.iterations);
  pair.print("thesis");
}

TEST(RtlEngine, AgreesOnTheThesisSphere) { solve_the_sphere(fixed::Method::cg); }
TEST(RtlEngine, AgreesOnTheThesisSphereWithJacobi) { solve_the_sphere(fixed::Method::jacobi_pcg); }

// All meshes over which the levels are compared.
TEST(RtlEngine, AgreesOnEveryMesh) {
  const std::vector<hvp::test::NamedMatrix> meshes = hvp::test::mesh_set();
  Pair pair(kEngineThesis);
  Settings settings = settings_of(kEngineThesis);
  settings.iterations = 3;
  for (const hvp::test::NamedMatrix& mesh : meshes) {
    SCOPED_TRACE(mesh.name);
    pair.load(mesh.matrix, settings);
    // Large enough that the longest words of d appear.
    pair.write_b(hvp::test::random_words(mesh.matrix.rows(), 30000, 11));
    pair.write_x(hvp::test::random_words(mesh.matrix.rows(), 2000, 12));
    pair.solve(settings);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(pair.solves, 7);
  EXPECT_EQ(pair.iterations, 3 * pair.solves);
  pair.print("thesis");
}

// The comparison itself: what only one of both has is seen, with its place.
TEST(RtlEngine, ADifferentWordIsFound) {
  const Settings settings = settings_of(kEngineThesis);
  Random random(6);
  const fixed::QuantisedMatrix matrix = hvp::test::random_matrix(30, 8, 12, random);
  const auto b = hvp::test::random_words(matrix.rows(), 30000, 7);
  Pair pair(kEngineThesis);
  pair.load(matrix, settings);
  pair.both.rtl().write_b(b);
  auto other = b;
  other[17] += 40;
  pair.engine.write_b(other);
  pair.start(settings);
  sc_core::sc_start();
  pair.both.end_solve();
  EXPECT_EQ(pair.both.difference(),
            "b, component 2 of node 5, is " + std::to_string(b[17]) + " in RTL and " +
                std::to_string(other[17]) +
                " in the cycle-accurate engine at clock 0 of solve 1, iteration 0");
}

std::string refused_architecture(const std::function<void(accel::Architecture&)>& change) {
  accel::Architecture a;
  change(a);
  try {
    require_fitting(kEngineThesis, a);
  } catch (const InputError& e) {
    return e.key();
  }
  return "";
}

std::string refused_settings(const std::function<void(Settings&)>& change) {
  Settings s;
  change(s);
  try {
    require_fitting(kEngineThesis, s);
  } catch (const InputError& e) {
    return e.key();
  }
  return "";
}

TEST(RtlEngine, WhatItIsNotBuiltForIsRefusedByKey) {
  using A = accel::Architecture;
  EXPECT_EQ(refused_architecture([](A&) {}), "");
  EXPECT_EQ(refused_architecture([](A& a) { a.package = 7; }), "package");
  EXPECT_EQ(refused_architecture([](A& a) { a.partitions = 6; }), "partitions");
  EXPECT_EQ(refused_architecture([](A& a) { a.nodes_per_clock = 3; }), "nodes_per_clock");
  EXPECT_EQ(refused_architecture([](A& a) { a.result_queue = 12; }), "result_queue");
  EXPECT_EQ(refused_architecture([](A& a) { a.division_clocks = 69; }), "division_clocks");
  EXPECT_EQ(refused_architecture([](A& a) { a.division_clocks = 68; }), "");
  EXPECT_EQ(refused_architecture([](A& a) { a.direction_banks = 2; }), "direction_banks");
  EXPECT_EQ(refused_architecture([](A& a) { a.rows_in_parallel = 1; }), "rows_in_parallel");
  EXPECT_EQ(refused_architecture([](A& a) { a.direction_memory = accel::DirectionMemory::stall; }),
            "direction_memory");
  EXPECT_EQ(refused_settings([](Settings&) {}), "");
  EXPECT_EQ(refused_settings([](Settings& s) { s.method = fixed::Method::jacobi_pcg; }), "");
  EXPECT_EQ(refused_settings([](Settings& s) { s.method = fixed::Method::block_jacobi_pcg; }),
            "method");
  EXPECT_EQ(refused_settings([](Settings& s) { s.vector_bits = 17; }), "vector_bits");
  EXPECT_EQ(refused_settings([](Settings& s) { s.scalar_bits = 128; }), "scalar_bits");
  EXPECT_EQ(refused_settings([](Settings& s) { s.overflow = fixed::Overflow::wrap; }), "overflow");
  EXPECT_EQ(
      refused_settings([](Settings& s) { s.coefficient_format = fixed::CoefficientFormat::fixed; }),
      "coefficient_format");
  EXPECT_EQ(refused_settings([](Settings& s) { s.scaling_down = false; }), "scaling_down");
  EXPECT_EQ(refused_settings([](Settings& s) { s.scaling_step = 2; }), "scaling_step");
  EXPECT_EQ(refused_settings([](Settings& s) { s.static_shift = 16; }), "static_shift");
}

}  // namespace
}  // namespace hvp::vp::rtl::rtl_host_test
