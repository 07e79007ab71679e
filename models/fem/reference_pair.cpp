#include "models/fem/reference_pair.h"

#include <algorithm>
#include <cassert>

#include "models/index.h"

namespace hvp::fem {

ReferencePair::ReferencePair(DirectSolver& one, DirectSolver& other) : one_(one), other_(other) {
  one.require_regular();
  other.require_regular();
  const int rows = one.rows();
  if (rows == 0 || other.rows() != rows) return;
  const TriangularFactor l = one.factor();
  const TriangularFactor m = other.factor();
  alike_ = std::equal(l.begin, l.begin + rows + 1, m.begin) &&
           std::equal(l.row, l.row + l.begin[rows], m.row) &&
           std::equal(one.permutation(), one.permutation() + rows, other.permutation());
  if (!alike_) return;
  factor_.reserve(2 * at(l.begin[rows]));
  static_assert(__STDCPP_DEFAULT_NEW_ALIGNMENT__ >= 16);  // as Substitution asks
  for (int k = 0; k < l.begin[rows]; ++k) {
    factor_.push_back(l.value[k]);
    factor_.push_back(m.value[k]);
  }
  scratch_.resize(2 * at(rows));
}

void ReferencePair::solve(const System& one, const System& other) {
  if (!alike_) {
    one_.solve(one.f, one.x);
    other_.solve(other.f, other.x);
    return;
  }
  const std::size_t rows = scratch_.size() / 2;
  assert(one.f.size() == rows && other.f.size() == rows);
  assert(one.x.size() == rows && other.x.size() == rows);
  const int* place = one_.permutation();
  for (std::size_t i = 0; i < rows; ++i) {
    double* const entry = &scratch_[2 * at(place[i])];
    entry[0] = one.f[i];
    entry[1] = other.f[i];
  }
  TriangularFactor both = one_.factor();
  both.value = factor_.data();
  one_.substitution_.forward_both(both, scratch_.data());
  for (std::size_t i = 0; i < rows; ++i) {
    scratch_[2 * i] /= one_.pivot_[i];
    scratch_[2 * i + 1] /= other_.pivot_[i];
  }
  one_.substitution_.backward_both(both, scratch_.data());
  for (std::size_t i = 0; i < rows; ++i) {
    const double* const entry = &scratch_[2 * at(place[i])];
    one.x[i] = entry[0];
    other.x[i] = entry[1];
  }
}

void ReferencePair::solve_with_contact(const System& one, const System& other,
                                       std::span<const int> patch,
                                       std::span<const Eigen::Vector3d> u) {
  one_.prepare_contact(patch);
  other_.prepare_contact(patch);
  solve(one, other);
  one_.impose_contact(u, one.x);
  other_.impose_contact(u, other.x);
}

}  // namespace hvp::fem
