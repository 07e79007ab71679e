#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <array>
#include <cstddef>
#include <vector>

#include "models/fit/tissue_system.h"

namespace hvp::fit {

// One unknown's values in all fields that are computed together.
template <std::size_t Fields>
using FieldRow = std::array<double, Fields>;

// The factors L·D·Lᵀ of k.λ·K_λ + k.μ·K_μ + m·M, in the order of the system's unknowns.
class TissueFactors {
 public:
  TissueFactors(const TissueSystem& system, const LamePair& k, double m);

  bool positive_definite() const { return positive_definite_; }

  // Solves for all fields in one pass over L, in place.
  template <std::size_t Fields>
  void solve(std::vector<FieldRow<Fields>>& x) const {
    for (std::size_t first = 0; first < x.size(); first += 3) forward<Fields>(first, x.data());
    for (std::size_t first = x.size(); first > 0; first -= 3) backward<Fields>(first - 3, x.data());
  }

 private:
  // The columns of L that belong to a node's three unknowns, which have the same pattern below
  // them.
  struct Columns {
    double in_x_y, in_x_z, in_y_z;  // entries of L between the three
    std::size_t rows;               // number of rows below
    const int* row;
    const double* x;
    const double* y;
    const double* z;
  };
  Columns columns(std::size_t first) const {
    const auto& l = factors_.matrixL().nestedExpression();
    const int* begin = l.outerIndexPtr() + first;
    const double* value = l.valuePtr();
    const double* x = value + begin[0];
    const double* y = value + begin[1];
    return {x[0],
            x[1],
            y[0],
            static_cast<std::size_t>(begin[3] - begin[2]),
            l.innerIndexPtr() + begin[2],
            x + 2,
            y + 1,
            value + begin[2]};
  }

  // Eigen computes two fields at a time; compilers vectorise plain loops only sometimes.
  template <std::size_t Fields>
  using Row = Eigen::Array<double, static_cast<int>(Fields), 1>;

  template <std::size_t Fields>
  void forward(std::size_t first, FieldRow<Fields>* all) const {
    using Rows = Eigen::Map<Row<Fields>>;
    const Columns l = columns(first);
    const Row<Fields> x = Rows(all[first].data());
    const Row<Fields> y = Rows(all[first + 1].data()) - l.in_x_y * x;
    const Row<Fields> z = Rows(all[first + 2].data()) - l.in_x_z * x - l.in_y_z * y;
    Rows(all[first + 1].data()) = y;
    Rows(all[first + 2].data()) = z;
    for (std::size_t k = 0; k < l.rows; ++k) {
      Rows(all[l.row[k]].data()) -= l.x[k] * x + l.y[k] * y + l.z[k] * z;
    }
  }

  template <std::size_t Fields>
  void backward(std::size_t first, FieldRow<Fields>* all) const {
    using Rows = Eigen::Map<Row<Fields>>;
    const Columns l = columns(first);
    const double* scale = &inverse_pivot_[first];
    Row<Fields> x = Rows(all[first].data()) * scale[0];
    Row<Fields> y = Rows(all[first + 1].data()) * scale[1];
    Row<Fields> z = Rows(all[first + 2].data()) * scale[2];
    for (std::size_t k = 0; k < l.rows; ++k) {
      const Row<Fields> known = Rows(all[l.row[k]].data());
      x -= l.x[k] * known;
      y -= l.y[k] * known;
      z -= l.z[k] * known;
    }
    y -= l.in_y_z * z;
    x -= l.in_x_y * y + l.in_x_z * z;
    Rows(all[first].data()) = x;
    Rows(all[first + 1].data()) = y;
    Rows(all[first + 2].data()) = z;
  }

  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>
      factors_;
  std::vector<double> inverse_pivot_;
  bool positive_definite_ = false;
};

inline TissueFactors::TissueFactors(const TissueSystem& system, const LamePair& k, double m) {
  // The matrix is symmetric, so that its rows are the columns that Eigen expects.
  const int n = system.unknowns();
  std::vector<double> value(system.column.size());
  for (std::size_t i = 0; i < value.size(); ++i) {
    value[i] = combine(k, system.stiffness[i]) + m * system.mass[i];
  }
  const Eigen::Map<const Eigen::SparseMatrix<double>> matrix(
      n, n, static_cast<Eigen::Index>(value.size()), system.row_begin.data(), system.column.data(),
      value.data());
  factors_.compute(matrix);
  if (factors_.info() != Eigen::Success) return;
  const Eigen::VectorXd pivots = factors_.vectorD();
  // As in fem::DirectSolver: a pivot with fewer than two digits left is zero.
  if (!pivots.allFinite() || !(pivots.minCoeff() > 1e-14 * pivots.maxCoeff())) return;
  inverse_pivot_.resize(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) inverse_pivot_[static_cast<std::size_t>(i)] = 1 / pivots[i];
  positive_definite_ = true;
}

}  // namespace hvp::fit
