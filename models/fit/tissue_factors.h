#pragma once

#include <Eigen/SparseCholesky>
#include <array>
#include <cstddef>
#include <vector>

#include "models/fit/tissue_system.h"

namespace hvp::fit {

// A row of numbers for each unknown, one for each of the fields that are computed together.
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
  // The columns of a node's three unknowns, which have one pattern below them.
  struct Columns {
    double in_x_y, in_x_z, in_y_z;  // L between the three
    std::size_t rows;               // below
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

  template <std::size_t Fields>
  void forward(std::size_t first, FieldRow<Fields>* all) const {
    const Columns l = columns(first);
    const FieldRow<Fields> x = all[first];
    FieldRow<Fields> y = all[first + 1];
    FieldRow<Fields> z = all[first + 2];
    for (std::size_t f = 0; f < Fields; ++f) {
      y[f] -= l.in_x_y * x[f];
      z[f] -= l.in_x_z * x[f] + l.in_y_z * y[f];
    }
    all[first + 1] = y;
    all[first + 2] = z;
    for (std::size_t k = 0; k < l.rows; ++k) {
      double* target = all[l.row[k]].data();
      for (std::size_t f = 0; f < Fields; ++f) {
        target[f] -= l.x[k] * x[f] + l.y[k] * y[f] + l.z[k] * z[f];
      }
    }
  }

  template <std::size_t Fields>
  void backward(std::size_t first, FieldRow<Fields>* all) const {
    const Columns l = columns(first);
    FieldRow<Fields> x = {};
    FieldRow<Fields> y = {};
    FieldRow<Fields> z = {};
    for (std::size_t k = 0; k < l.rows; ++k) {
      const double* known = all[l.row[k]].data();
      for (std::size_t f = 0; f < Fields; ++f) {
        x[f] += l.x[k] * known[f];
        y[f] += l.y[k] * known[f];
        z[f] += l.z[k] * known[f];
      }
    }
    const double* scale = &inverse_pivot_[first];
    for (std::size_t f = 0; f < Fields; ++f) {
      z[f] = all[first + 2][f] * scale[2] - z[f];
      y[f] = all[first + 1][f] * scale[1] - y[f] - l.in_y_z * z[f];
      x[f] = all[first][f] * scale[0] - x[f] - l.in_x_y * y[f] - l.in_x_z * z[f];
    }
    all[first] = x;
    all[first + 1] = y;
    all[first + 2] = z;
  }

  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>
      factors_;
  std::vector<double> inverse_pivot_;
  bool positive_definite_ = false;
};

}  // namespace hvp::fit
