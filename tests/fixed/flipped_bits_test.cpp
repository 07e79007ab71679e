// The comparison of two solvers notices a single wrong bit, wherever it is.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>

#include <gtest/gtest.h>

#include "models/fixed/fast/fast_solver.h"
#include "models/fixed/reference_solver.h"
#include "tests/fixed/elastic_box.h"
#include "tests/fixed/record.h"

namespace hvp::fixed::flipped_bits_test {
namespace {

using test::difference;
using test::Random;
using test::record;
using test::Record;
using Vector = std::vector<std::int32_t>;

struct System {
  Settings settings;
  QuantisedMatrix matrix;
  Vector b, guess;
};

System elastic_system(Method method, int vector_bits = 16) {
  System system;
  system.settings.method = method;
  system.settings.vector_bits = vector_bits;
  system.settings.iterations = 12;
  system.matrix =
      quantise(test::make_body({.cells_x = 3, .cells_y = 3, .cells_z = 3}).stiffness, 12);
  Random random(5);
  for (int i = 0; i < system.matrix.rows(); ++i) {
    system.b.push_back(random.below(4001) - 2000);
    system.guess.push_back(1 + random.below(200));
  }
  return system;
}

Record reference_record(const System& system) {
  ReferenceSolver solver(system.settings);
  solver.load(system.matrix);
  return record(solver, system.b, system.guess);
}

template <typename T>
void flip(T& value, int bit) {
  std::array<unsigned char, sizeof(T)> bytes{};
  std::memcpy(bytes.data(), &value, sizeof(T));
  bytes[static_cast<std::size_t>(bit / 8)] ^= static_cast<unsigned char>(1U << (bit % 8));
  std::memcpy(&value, bytes.data(), sizeof(T));
}

// Any bit of any word or scalar of any iteration, and of the report.
TEST(FlippedBit, OfWhatIsSeenIsNoticed) {
  for (const Method method : {Method::jacobi_pcg, Method::pipelined_cg}) {
    const Record right = reference_record(elastic_system(method));
    ASSERT_EQ(difference(right, right), "");
    ASSERT_EQ(right.iterations.size(), 12U);
    Random random(6);
    const auto expect_noticed = [&](const char* what, auto damage) {
      for (int trial = 0; trial < 64; ++trial) {
        Record wrong = right;
        damage(wrong, wrong.iterations[static_cast<std::size_t>(random.below(12))]);
        EXPECT_NE(difference(right, wrong), "") << what;
        EXPECT_NE(difference(wrong, right), "") << what;
      }
    };
    for (std::size_t v = 0; v < 8; ++v) {
      if (right.iterations[0].vectors[v].empty()) continue;
      expect_noticed("vector", [&](Record&, test::IterationRecord& i) {
        Vector& words = i.vectors[v];
        flip(words[static_cast<std::size_t>(random.below(static_cast<int>(words.size())))],
             random.below(32));
      });
    }
    const auto bit = [&](auto& value) {
      flip(value, random.below(8 * static_cast<int>(sizeof(value))));
    };
    expect_noticed("d_q", [&](Record&, test::IterationRecord& i) { bit(i.d_q); });
    expect_noticed("z_r", [&](Record&, test::IterationRecord& i) { bit(i.z_r); });
    expect_noticed("alpha", [&](Record&, test::IterationRecord& i) { bit(i.alpha.mantissa); });
    expect_noticed("alpha", [&](Record&, test::IterationRecord& i) { bit(i.alpha.exponent); });
    expect_noticed("beta", [&](Record&, test::IterationRecord& i) { bit(i.beta.mantissa); });
    expect_noticed("beta", [&](Record&, test::IterationRecord& i) { bit(i.beta.exponent); });
    expect_noticed("exponent",
                   [&](Record&, test::IterationRecord& i) { bit(i.residual_exponent); });
    expect_noticed("exponent",
                   [&](Record&, test::IterationRecord& i) { bit(i.direction_exponent); });
    expect_noticed("solution", [&](Record& r, test::IterationRecord&) { bit(r.x[5]); });
    expect_noticed("iterations",
                   [&](Record& r, test::IterationRecord&) { bit(r.report.iterations); });
    expect_noticed("saturations",
                   [&](Record& r, test::IterationRecord&) { bit(r.report.saturations); });
    expect_noticed("wraps", [&](Record& r, test::IterationRecord&) { bit(r.report.wraps); });
    expect_noticed("flags", [&](Record& r, test::IterationRecord&) { bit(r.report.flags); });
    expect_noticed("norm", [&](Record& r, test::IterationRecord&) { bit(r.report.rhs_norm); });
    expect_noticed("norm",
                   [&](Record& r, test::IterationRecord&) { bit(r.report.start_residual_norm); });
    expect_noticed("norm", [&](Record& r, test::IterationRecord&) { bit(r.report.residual_norm); });
    expect_noticed("norm",
                   [&](Record& r, test::IterationRecord&) { bit(r.report.true_residual_norm); });
    expect_noticed("norm",
                   [&](Record& r, test::IterationRecord&) { bit(r.report.rounding_floor); });
  }
}

// Any bit of any word of the matrix, on one side.
TEST(FlippedBit, OfTheMatrixIsNoticed) {
  const System system = elastic_system(Method::cg);
  const Record right = reference_record(system);
  fast::FastSolver solver(system.settings, fast::portable_passes());
  solver.load(system.matrix);
  ASSERT_EQ(difference(right, record(solver, system.b, system.guess)), "");
  Random random(7);
  for (int trial = 0; trial < 300; ++trial) {
    QuantisedMatrix wrong = system.matrix;
    const int word = random.below(static_cast<int>(wrong.value.size()));
    flip(wrong.value[static_cast<std::size_t>(word)], random.below(12));
    solver.load(wrong);
    EXPECT_NE(difference(right, record(solver, system.b, system.guess)), "") << "word " << word;
  }
}

// The portable passes with one that errs: after so many of its calls it flips a bit of a word that
// it has written.
struct Fault {
  int calls = 0;  // until it happens; negative: never
  std::size_t word = 0;
  std::size_t rows = 1;
  int bit = 0;
  bool happened = false;
} fault;

template <typename Word>
void err(Word* out, std::size_t size) {
  if (fault.calls-- != 0) return;
  flip(out[fault.word % size], fault.bit);
  fault.happened = true;
}

// What is found of a vector holds for the wrong word too, as every pass relies on it.
fast::Found with_largest(fast::Found found, const std::int32_t* out) {
  for (std::size_t i = 0; i < fault.rows; ++i) {
    const auto size = static_cast<std::uint64_t>(std::abs(std::int64_t{out[i]}));
    found.largest = std::max(found.largest, size);
  }
  return found;
}

fast::Found erring_combine(const fast::Terms& terms) {
  const fast::Found found = fast::portable_passes().combine(terms);
  err(terms.out, fault.rows);
  return with_largest(found, terms.out);
}

fast::FoundBoth erring_combine_both(const fast::Terms& first, const fast::Terms& second) {
  const fast::FoundBoth found = fast::portable_passes().combine_both(first, second);
  err(fault.word % 2 == 0 ? first.out : second.out, fault.rows);
  return {.first = with_largest(found.first, first.out),
          .second = with_largest(found.second, second.out)};
}

fast::Found erring_multiply_entries(const fast::Products& products) {
  const fast::Found found = fast::portable_passes().multiply_entries(products);
  err(products.out, fault.rows);
  return with_largest(found, products.out);
}

fast::Found erring_inner_product(const std::int32_t* a, const std::int32_t* b, std::size_t size) {
  fast::Found found = fast::portable_passes().inner_product(a, b, size);
  err(&found.dot, 1);
  return found;
}

void erring_to_short(const std::int32_t* in, std::int16_t* out, std::size_t size) {
  fast::portable_passes().to_short(in, out, size);
  // A node has three words there and one that nothing is asked of.
  err(out + fault.word % fault.rows / 3, fault.rows);
}

fast::Found erring_multiply_paired(const fast::PairedSlices& a, const std::int16_t* vector,
                                   std::int32_t* out) {
  const fast::Found found = fast::portable_passes().multiply_paired(a, vector, out);
  err(out, fault.rows);
  return with_largest(found, out);
}

fast::Found erring_in_the_product(const fast::PairedSlices& a, const std::int16_t* vector,
                                  std::int32_t* out) {
  fast::Found found = fast::portable_passes().multiply_paired(a, vector, out);
  err(&found.dot, 1);
  return found;
}

// Any bit of what a pass writes, within a solve.
TEST(FlippedBit, OfWhatAPassWritesIsNoticed) {
  constexpr std::size_t kInnerProduct = 2;
  constexpr std::size_t kToShort = 3;
  constexpr std::size_t kProductsSum = 6;
  std::array<fast::Passes, 7> passes{};
  passes.fill(fast::portable_passes());
  passes[0].combine = erring_combine;
  passes[1].multiply_entries = erring_multiply_entries;
  passes[kInnerProduct].inner_product = erring_inner_product;
  passes[kToShort].to_short = erring_to_short;
  passes[4].multiply_paired = erring_multiply_paired;
  passes[5].combine_both = erring_combine_both;
  passes[kProductsSum].multiply_paired = erring_in_the_product;
  Random random(8);
  for (std::size_t which = 0; which < passes.size(); ++which) {
    // Words of 16 bits have their inner products from the matrix-vector product.
    const System system = elastic_system(Method::jacobi_pcg, which == kInnerProduct ? 24 : 16);
    const Record right = reference_record(system);
    fast::FastSolver solver(system.settings, passes[which]);
    solver.load(system.matrix);
    const bool sum = which == kInnerProduct || which == kProductsSum;
    const int bits = which == kToShort ? 16 : sum ? 60 : 31;
    int noticed = 0;
    for (int trial = 0; trial < 100; ++trial) {
      // The first three calls belong to the job and the first residual, and to no iteration.
      fault = {.calls = 3 + random.below(8),
               .word = static_cast<std::size_t>(random.below(10000)),
               .rows = system.b.size(),
               .bit = random.below(bits)};
      const Record wrong = record(solver, system.b, system.guess);
      EXPECT_TRUE(fault.happened) << "pass " << which;
      noticed += difference(right, wrong).empty() ? 0 : 1;
    }
    EXPECT_EQ(noticed, 100) << "pass " << which;
    fault.calls = -1;
    EXPECT_EQ(difference(right, record(solver, system.b, system.guess)), "");
  }
}

}  // namespace
}  // namespace hvp::fixed::flipped_bits_test
