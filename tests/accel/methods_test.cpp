// Clocks and resources of the five methods, against schedules counted out by hand.
#include <algorithm>
#include <array>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "app/devices/devices.h"
#include "models/accel/cycles.h"
#include "models/accel/fit.h"
#include "models/accel/memory.h"
#include "models/config/input_error.h"

namespace hvp::accel::methods_test {
namespace {

using fixed::Method;

const Device& ep2s60() { return devices::built_in("EP2S60"); }

constexpr std::array kAll = {Method::cg, Method::jacobi_pcg, Method::block_jacobi_pcg,
                             Method::chronopoulos_gear, Method::pipelined_cg};

// 500 nodes of five packages: 500 packages a partition, 520 clocks a product; 250 + 20 a pass of
// the vector unit; 68 a division.
Pattern thesis_mesh() { return {std::vector<int>(500, 13)}; }
constexpr std::int64_t kProduct = 520;
constexpr std::int64_t kPass = 270;
constexpr std::int64_t kDivision = 68;

SolveCycles clocks(const SolveWork& work, const Architecture& a = {}) {
  return solve_cycles(a, thesis_mesh(), work);
}

// When each step of an iteration ends, step by step: a step begins when all that it needs has
// ended. The loop's period is what one round adds.
std::int64_t gear_period(std::int64_t product, std::int64_t pass, std::int64_t division,
                         std::int64_t curvature, bool one_pass) {
  std::int64_t alpha = 0;
  std::int64_t vectors = 0;  // group c of the round before
  std::int64_t period = 0;
  for (int round = 0; round < 8; ++round) {
    // Without dynamic scaling group c is part of this pass.
    const std::int64_t residual = std::max(alpha, vectors) + pass;
    const std::int64_t beta = residual + division;
    const std::int64_t carried = beta + curvature;
    const std::int64_t delta = residual + product;
    const std::int64_t before = std::max(alpha, vectors);
    alpha = std::max(carried, delta) + division;
    // What is left of dᵀAd decides whether β stays what it is.
    vectors = one_pass ? 0 : std::max(beta, std::max(carried, delta)) + pass;
    period = std::max(alpha, vectors) - before;
  }
  return period;
}

std::int64_t pipelined_period(std::int64_t product, std::int64_t pass, std::int64_t division,
                              std::int64_t curvature, bool one_pass) {
  std::int64_t ready = 0;  // for group b
  std::int64_t period = 0;
  for (int round = 0; round < 8; ++round) {
    const std::int64_t inner_products = ready + pass;  // γ and δ
    const std::int64_t alpha = inner_products + division + curvature + division;
    const std::int64_t a_w = inner_products + product;
    const std::int64_t next = std::max(alpha, a_w) + (one_pass ? 0 : pass);
    period = next - ready;
    ready = next;
  }
  return period;
}

TEST(MethodCycles, AnIterationOfTheThesisMesh) {
  EXPECT_EQ(clocks({.method = Method::cg}).iteration(), 1196);
  EXPECT_EQ(clocks({.method = Method::jacobi_pcg}).iteration(), 1196);
  EXPECT_EQ(clocks({.method = Method::block_jacobi_pcg}).iteration(), 1196);
  // Both divisions hide.
  EXPECT_EQ(clocks({.method = Method::chronopoulos_gear}).iteration(), 1196 - 2 * 68);
  EXPECT_EQ(clocks({.method = Method::pipelined_cg}).iteration(), 1196 - 2 * 68);
  // One pass of the vector unit less where no size has to be awaited, but α has to be.
  EXPECT_EQ(clocks({.method = Method::chronopoulos_gear, .dynamic_scaling = false}).iteration(),
            520 + 68 + 270);
  EXPECT_EQ(clocks({.method = Method::pipelined_cg, .dynamic_scaling = false}).iteration(),
            520 + 270);
}

// From a board whose divisions hide to one where they are the longest step.
TEST(MethodCycles, RecurrencesFollowTheirSchedule) {
  for (const int division : {68, 200, 300, 600, 1000}) {
    for (const int lanes : {1, 2, 16}) {
      for (const bool dynamic : {true, false}) {
        Architecture a;
        a.division_clocks = division;
        a.nodes_per_clock = lanes;
        a.direction_banks = lanes;  // ports for all lanes at once
        const std::int64_t pass = 20 + (500 + lanes - 1) / lanes;
        // One lane takes 500 rows one after the other, the first of them in the clock of its fifth
        // package.
        const std::int64_t product = lanes == 1 ? 524 : kProduct;
        // 63 bits of magnitude are four steps of 17, twice.
        EXPECT_EQ(clocks({.method = Method::chronopoulos_gear, .dynamic_scaling = dynamic}, a)
                      .iteration(),
                  gear_period(product, pass, division, 8, !dynamic))
            << division << " " << lanes << " " << dynamic;
        EXPECT_EQ(
            clocks({.method = Method::pipelined_cg, .dynamic_scaling = dynamic}, a).iteration(),
            pipelined_period(product, pass, division, 8, !dynamic))
            << division << " " << lanes << " " << dynamic;
      }
    }
  }
}

TEST(MethodCycles, LongScalarsTakeALongerDivision) {
  fixed::Settings s;
  EXPECT_EQ(clocks(longest_solve(s)).divisions, 2 * kDivision);
  s.scalar_bits = 128;
  EXPECT_EQ(clocks(longest_solve(s)).divisions, 2 * (kDivision + 8));
  Architecture a;
  a.division_clocks = 520;
  // β and β²·dᵀAd (127 bits in eight steps, twice) outlast the product, α the pass.
  EXPECT_EQ(clocks({.method = Method::chronopoulos_gear, .scalar_bits = 128}, a).divisions,
            520 + 16 - 520 + 520 - 270);
}

TEST(MethodCycles, SetUpMakesWhatTheMethodNeeds) {
  const auto setup = [](const SolveWork& work) { return clocks(work).setup; };
  const std::int64_t residual = kProduct + 2 * kPass;
  for (const Method method : {Method::cg, Method::jacobi_pcg, Method::block_jacobi_pcg}) {
    EXPECT_EQ(setup({.method = method}), residual);
  }
  // A·r, A·d, and the first α.
  EXPECT_EQ(setup({.method = Method::chronopoulos_gear}), residual + 2 * kProduct + kDivision);
  // A·r, A·d, A·A·r, A·A·d; the first two are brought to vector words.
  EXPECT_EQ(setup({.method = Method::pipelined_cg}), residual + 4 * kProduct + 2 * kPass);
  EXPECT_EQ(setup({.method = Method::pipelined_cg, .dynamic_scaling = false}),
            residual + 4 * kProduct);
  for (const Method method : kAll) {
    EXPECT_EQ(setup({.method = method, .extrapolated = true}) - setup({.method = method}), kPass);
    // bᵀb is formed as the rows of A·x are taken.
    EXPECT_EQ(setup({.method = method, .stop_test = true}), setup({.method = method}));
  }
}

TEST(MethodCycles, AResidualFormedAnewIsAProductAndAPassAndWhatFollowsFromIt) {
  for (const Method method :
       {Method::cg, Method::jacobi_pcg, Method::block_jacobi_pcg, Method::chronopoulos_gear}) {
    EXPECT_EQ(clocks({.method = method}).replacement, kProduct + kPass);
  }
  EXPECT_EQ(clocks({.method = Method::pipelined_cg}).replacement, kPass + 4 * kProduct + 2 * kPass);
  const SolveCycles c = clocks({.iterations = 60, .replacements = 6});
  EXPECT_EQ(c.total() - clocks({}).total(), 6 * (kProduct + kPass));
}

TEST(MethodCycles, ABreakdownIsSeenAfterTheProductOrBeforeIt) {
  for (const Method method : kAll) {
    const SolveWork whole{.method = method, .iterations = 7};
    SolveWork broken = whole;
    broken.broken_down = true;
    const bool known = method == Method::chronopoulos_gear || method == Method::pipelined_cg;
    EXPECT_EQ(clocks(broken).total() - clocks(whole).total(), known ? 0 : kProduct);
  }
}

TEST(SolveWork, FollowsTheSettingsAndTheReport) {
  fixed::Settings s;
  s.method = Method::pipelined_cg;
  s.iterations = 25;
  s.replace_residual_every = 10;
  s.start = fixed::Start::extrapolated;
  s.stop_residual = 1e-3;
  s.scalar_bits = 128;
  s.dynamic_scaling = false;
  const SolveWork longest = longest_solve(s);
  EXPECT_EQ(longest.method, Method::pipelined_cg);
  EXPECT_EQ(longest.iterations, 25);
  EXPECT_EQ(longest.replacements, 2);
  EXPECT_TRUE(longest.extrapolated);
  EXPECT_TRUE(longest.stop_test);
  EXPECT_FALSE(longest.dynamic_scaling);
  EXPECT_EQ(longest.scalar_bits, 128);
  EXPECT_EQ(longest.shortest_division, 76);

  fixed::Report reached;
  reached.iterations = 12;
  reached.replacements = 1;
  reached.reached = true;
  EXPECT_EQ(solve_made(s, reached).iterations, 12);
  EXPECT_EQ(solve_made(s, reached).replacements, 1);
  EXPECT_FALSE(solve_made(s, reached).broken_down);

  fixed::Report broken;
  broken.iterations = 3;
  broken.breakdowns = 1;
  EXPECT_EQ(solve_made(s, broken).iterations, 3);
  EXPECT_TRUE(solve_made(s, broken).broken_down);

  // Nothing was left to do, which a board that counts does not see.
  fixed::Report at_rest;
  EXPECT_EQ(solve_made(s, at_rest).iterations, 25);
  EXPECT_EQ(solve_made(s, at_rest).replacements, 0);
}

std::map<std::string, int> blocks_of(const WordLengths& words, const Architecture& a = {}) {
  std::map<std::string, int> blocks;
  for (const Allocation& allocation : usage(ep2s60(), a, words, thesis_mesh()).allocations) {
    blocks[allocation.use] = allocation.blocks;
  }
  return blocks;
}

int multipliers(const WordLengths& words) {
  for (const Resource& r : usage(ep2s60(), {}, words, thesis_mesh()).resources) {
    if (r.type == "multipliers") return r.used;
  }
  return -1;
}

// 500 words of 16 bits are two blocks; three components six; 32 bits twelve. Five partitions read
// a vector of their own.
TEST(MethodMemory, HoldsTheVectorsOfTheRecurrences) {
  using Blocks = std::map<std::string, int>;
  EXPECT_EQ(blocks_of({}), (Blocks{{"matrix", 180},
                                   {"d", 30},
                                   {"x", 6},
                                   {"b", 6},
                                   {"r", 6},
                                   {"A*d", 12},
                                   {"index", 2},
                                   {"results", 50}}));
  EXPECT_EQ(blocks_of({.method = Method::chronopoulos_gear}), (Blocks{{"matrix", 180},
                                                                      {"d", 6},
                                                                      {"x", 6},
                                                                      {"b", 6},
                                                                      {"r", 30},
                                                                      {"A*d", 12},
                                                                      {"A*r", 12},
                                                                      {"index", 2},
                                                                      {"results", 50}}));
  EXPECT_EQ(blocks_of({.method = Method::pipelined_cg}), (Blocks{{"matrix", 180},
                                                                 {"d", 6},
                                                                 {"x", 6},
                                                                 {"b", 6},
                                                                 {"r", 6},
                                                                 {"A*d", 6},
                                                                 {"A*r", 30},
                                                                 {"A*A*r", 12},
                                                                 {"A*A*d", 12},
                                                                 {"index", 2},
                                                                 {"results", 50}}));
  EXPECT_EQ(blocks_of({.method = Method::jacobi_pcg}), (Blocks{{"matrix", 180},
                                                               {"d", 30},
                                                               {"x", 6},
                                                               {"b", 12},
                                                               {"r", 12},
                                                               {"A*d", 12},
                                                               {"z", 12},
                                                               {"inverse diagonal", 12},
                                                               {"index", 2},
                                                               {"results", 50}}));
  EXPECT_EQ(blocks_of({.method = Method::block_jacobi_pcg}), (Blocks{{"matrix", 180},
                                                                     {"d", 30},
                                                                     {"x", 6},
                                                                     {"b", 12},
                                                                     {"r", 12},
                                                                     {"A*d", 12},
                                                                     {"z", 12},
                                                                     {"inverse blocks", 24},
                                                                     {"index", 2},
                                                                     {"results", 50}}));
  EXPECT_EQ(blocks_of({.extrapolated = true}).at("previous x"), 6);
  EXPECT_EQ(blocks_of({}).count("previous x"), 0U);
  Architecture two;
  two.direction_memory = DirectionMemory::two_copies;
  EXPECT_EQ(blocks_of({.method = Method::chronopoulos_gear}, two).at("r"), 60);
}

// 120 for the product and 21 for two nodes a clock (thesis Table 6.2); a node has three
// components, so that one product more a component is six.
TEST(MethodMemory, CountsTheMultipliersOfEachMethod) {
  EXPECT_EQ(multipliers({}), 141);
  EXPECT_EQ(multipliers({.stop_test = true}), 141 + 3);  // γ is ‖r‖²; the limit
  EXPECT_EQ(multipliers({.method = Method::jacobi_pcg}), 141 + 6 * 7);
  EXPECT_EQ(multipliers({.method = Method::jacobi_pcg, .stop_test = true}), 141 + 6 * 11 + 3);
  EXPECT_EQ(multipliers({.method = Method::block_jacobi_pcg}), 141 + 6 * 15);
  EXPECT_EQ(multipliers({.method = Method::block_jacobi_pcg, .stop_test = true}), 141 + 6 * 19 + 3);
  EXPECT_EQ(multipliers({.method = Method::chronopoulos_gear}), 141 + 1);
  EXPECT_EQ(multipliers({.method = Method::chronopoulos_gear, .dynamic_scaling = false}),
            141 + 6 * 3 + 1);
  EXPECT_EQ(multipliers({.method = Method::pipelined_cg}), 141 + 6 * 2 + 1);
  EXPECT_EQ(multipliers({.method = Method::pipelined_cg, .dynamic_scaling = false}),
            141 + 6 * 6 + 1);
  // Words beyond 18 bits take multipliers in pairs.
  EXPECT_EQ(multipliers({.vector_bits = 24}), 240 + 42);
  EXPECT_EQ(multipliers({.coefficient_bits = 20}), 120 + 42);
}

TEST(MethodMemory, FollowsTheSettings) {
  fixed::Settings s;
  s.matrix_bits = 14;
  s.vector_bits = 18;
  s.coefficient_bits = 20;
  s.method = Method::block_jacobi_pcg;
  s.start = fixed::Start::extrapolated;
  s.stop_residual = 0.5;
  s.dynamic_scaling = false;
  const WordLengths w = word_lengths(s);
  EXPECT_EQ(w.matrix_bits, 14);
  EXPECT_EQ(w.vector_bits, 18);
  EXPECT_EQ(w.coefficient_bits, 20);
  EXPECT_EQ(w.method, Method::block_jacobi_pcg);
  EXPECT_TRUE(w.extrapolated);
  EXPECT_TRUE(w.stop_test);
  EXPECT_FALSE(w.dynamic_scaling);
  EXPECT_TRUE(w.preconditioned());
  EXPECT_EQ(w.preconditioned(), s.preconditioned());
}

// Chronopoulos and Gear's method fits where plain CG does; the pipelined one does not.
TEST(MethodMemory, TheEp2s60TakesOneOfTheTwo) {
  EXPECT_TRUE(usage(ep2s60(), {}, {.method = Method::chronopoulos_gear}, thesis_mesh()).fits());
  try {
    require_fit(ep2s60(), {}, {.method = Method::pipelined_cg}, thesis_mesh());
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(),
                 "the EP2S60 cannot hold this system of 500 nodes: 264 M4K of 255, 154 "
                 "multipliers of 144; what fits: accelerator.partitions = 2");
  }
  const Device& larger = devices::built_in("EP2S180");
  for (const Method method : kAll) {
    EXPECT_TRUE(usage(larger, {}, {.method = method}, thesis_mesh()).fits());
  }
}

}  // namespace
}  // namespace hvp::accel::methods_test
