// Every kernel gives the reference's words, to the last bit of everything that can be seen.
#include <cstdlib>
#include <memory>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fixed/kernel.h"
#include "models/fixed/reference_solver.h"
#include "tests/fixed/allocation_count.h"
#include "tests/fixed/elastic_box.h"
#include "tests/fixed/random_systems.h"
#include "tests/fixed/record.h"

namespace hvp::fixed {
namespace {

using test::Random;
using Vector = std::vector<std::int32_t>;

std::vector<Kernel> fast_kernels() {
  std::vector<Kernel> kernels = supported_kernels();
  std::erase(kernels, Kernel::reference);
  return kernels;
}

// A solver of each kind with the same matrix, which all of them watch.
class Contest {
 public:
  Contest(const Settings& settings, QuantisedMatrix matrix)
      : matrix_(std::move(matrix)), original_(matrix_), reference_(settings) {
    for (const Kernel kernel : fast_kernels()) fast_.push_back(make_solver(settings, kernel));
    load();
  }

  void load() {
    reference_.load(matrix_);
    for (const auto& solver : fast_) solver->load(matrix_);
  }
  void set_contact(int node, std::int32_t diagonal) {
    matrix_.set_contact(node, diagonal);
    update(node);
  }
  void restore(int node) {
    matrix_.restore_row(node, original_.row(node));
    update(node);
  }
  const QuantisedMatrix& matrix() const { return matrix_; }

  // Returns the reference's solution.
  test::Record compare(const Vector& b, const Vector& guess) {
    const test::Record expected = test::record(reference_, b, guess);
    for (std::size_t i = 0; i < fast_.size(); ++i) {
      EXPECT_EQ(difference(expected, test::record(*fast_[i], b, guess)), "")
          << name(fast_kernels()[i]) << ", " << matrix_.block_rows() << " nodes";
    }
    return expected;
  }

 private:
  void update(int node) {
    reference_.update(node);
    for (const auto& solver : fast_) solver->update(node);
  }

  QuantisedMatrix matrix_;
  QuantisedMatrix original_;
  ReferenceSolver reference_;
  std::vector<std::unique_ptr<Solver>> fast_;
};

// Solves, presses a node or two, lets them go, and solves again each time from where it stands.
void compare_with_contact(Contest& contest, const Settings& s, Random& random) {
  const int rows = contest.matrix().rows();
  const Vector b = test::random_words(random, rows, s.residual_bits());
  Vector x = test::random_words(random, rows, s.vector_bits);
  x = contest.compare(b, x).x;
  if (rows == 0) return;
  const int first = random.below(rows / 3);
  const int second = random.below(rows / 3);
  const auto limit = static_cast<int>(std::ldexp(1.0, s.matrix_bits - 1)) - 1;
  contest.set_contact(first, 1 + random.below(limit));
  contest.set_contact(second, 1 + random.below(limit));
  x = contest.compare(b, x).x;
  contest.restore(first);
  contest.compare(b, x);
  if (second == first) return;
  contest.restore(second);
  contest.compare(b, x);
}

class Agreement : public testing::TestWithParam<int> {};

// 12 · 100 systems with up to 4 solves each.
TEST_P(Agreement, OnRandomSystems) {
  constexpr int kSystems = 100;
  Random random(static_cast<std::uint64_t>(1 + GetParam()));
  for (int i = 0; i < kSystems && !testing::Test::HasFailure(); ++i) {
    const Settings s = test::random_settings(random);
    SCOPED_TRACE(test::describe(s));
    Contest contest(s, test::random_matrix(random, s.matrix_bits, i % 10 == 0 ? 70 : 14));
    compare_with_contact(contest, s, random);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, Agreement, testing::Range(0, 12));

}  // namespace
}  // namespace hvp::fixed
