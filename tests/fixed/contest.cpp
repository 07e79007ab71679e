#include "tests/fixed/contest.h"

#include <utility>

#include <gtest/gtest.h>

namespace hvp::fixed::test {

std::vector<Kernel> fast_kernels() {
  std::vector<Kernel> kernels = supported_kernels();
  std::erase(kernels, Kernel::reference);
  return kernels;
}

Contest::Contest(const Settings& settings, QuantisedMatrix matrix)
    : matrix_(std::move(matrix)), original_(matrix_), reference_(settings) {
  reference_.load(matrix_);
  for (const Kernel kernel : fast_kernels()) {
    fast_.push_back(make_solver(settings, kernel));
    fast_.back()->load(matrix_);
  }
}

void Contest::set_contact(int node, std::int32_t diagonal) {
  matrix_.set_contact(node, diagonal);
  update(node);
}

void Contest::restore(int node) {
  matrix_.restore_row(node, original_.row(node));
  update(node);
}

void Contest::update(int node) {
  reference_.update(node);
  for (const auto& solver : fast_) solver->update(node);
}

Record Contest::compare(const std::vector<std::int32_t>& b,
                        const std::vector<std::int32_t>& guess) {
  Record expected = record(reference_, b, guess);
  for (std::size_t i = 0; i < fast_.size(); ++i) {
    EXPECT_EQ(difference(expected, record(*fast_[i], b, guess)), "")
        << name(fast_kernels()[i]) << ", " << matrix_.block_rows() << " nodes";
  }
  return expected;
}

}  // namespace hvp::fixed::test
