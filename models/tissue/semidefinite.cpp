#include "models/tissue/semidefinite.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace hvp::tissue {

namespace {

constexpr std::size_t kRows = 9;
using Matrix = std::array<std::array<double, kRows>, kRows>;

// Twice the orthonormal vectors over the four nodes that are orthogonal to a translation.
constexpr std::array<std::array<double, 4>, 3> kBasis = {
    {{1, 1, -1, -1}, {1, -1, 1, -1}, {1, -1, -1, 1}}};
constexpr int kMostSweeps = 12;

// The tangent in that basis.
Matrix reduced(const Blocks<double>& blocks) {
  Matrix m{};
  std::size_t pair = 0;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = a; b < 4; ++b) {
      const Tensor<double>& block = blocks[pair++];
      for (std::size_t p = 0; p < 3; ++p) {
        for (std::size_t q = p; q < 3; ++q) {
          const double one = 0.25 * kBasis[p][a] * kBasis[q][b];
          const double other = 0.25 * kBasis[p][b] * kBasis[q][a];
          for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
              double& entry = m[3 * p + i][3 * q + j];
              entry += one * block[3 * i + j];
              if (a != b) entry += other * block[3 * j + i];
            }
          }
        }
      }
    }
  }
  for (std::size_t i = 0; i < kRows; ++i) {
    for (std::size_t j = 0; j < i; ++j) m[i][j] = m[j][i];
  }
  return m;
}
// A block once for each of the six pairs of the basis, and those of different nodes twice.
constexpr Operations kReduced = {.add_multiply = 6.0 * (4 + 2 * 6) * 9 * 2};

// True if Cholesky's factorisation of m + shift·I exists.
bool definite(Matrix m, double shift) {
  for (std::size_t k = 0; k < kRows; ++k) {
    const double pivot = m[k][k] + shift;
    if (!(pivot > 0)) return false;
    for (std::size_t i = k + 1; i < kRows; ++i) {
      const double factor = m[i][k] / pivot;
      for (std::size_t j = i; j < kRows; ++j) m[j][i] -= factor * m[j][k];
    }
  }
  return true;
}
constexpr Operations kDefinite = {.add_multiply = 9 + 2 * 120, .divisions = 36};

// One of Jacobi's rotations, which makes m[p][q] zero (Golub, Van Loan, Matrix Computations, §8.5).
void rotate(Matrix& m, Matrix& vectors, std::size_t p, std::size_t q) {
  const double slope = (m[q][q] - m[p][p]) / (2 * m[p][q]);
  const double t = (slope < 0 ? -1 : 1) / (std::abs(slope) + std::sqrt(slope * slope + 1));
  const double c = 1 / std::sqrt(t * t + 1);
  const double s = t * c;
  for (std::size_t k = 0; k < kRows; ++k) {
    const double left = m[k][p];
    const double right = m[k][q];
    m[k][p] = c * left - s * right;
    m[k][q] = s * left + c * right;
  }
  for (std::size_t k = 0; k < kRows; ++k) {
    const double upper = m[p][k];
    const double lower = m[q][k];
    m[p][k] = c * upper - s * lower;
    m[q][k] = s * upper + c * lower;
    const double left = vectors[k][p];
    const double right = vectors[k][q];
    vectors[k][p] = c * left - s * right;
    vectors[k][q] = s * left + c * right;
  }
}
constexpr Operations kRotation = {
    .add_multiply = 9 + 3.0 * 6 * kRows, .divisions = 3, .functions = 2};

// Adds |λ|·w·wᵀ, where w are the nodes' shares of an eigenvector. Its products are the same to the
// last bit in both triangles.
void add_outer(double weight, const std::array<double, kRows>& v, Blocks<double>& blocks) {
  std::array<Vector<double>, 4> w{};
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t i = 0; i < 3; ++i) {
      w[a][i] = 0.5 * (kBasis[0][a] * v[i] + kBasis[1][a] * v[3 + i] + kBasis[2][a] * v[6 + i]);
    }
  }
  std::size_t pair = 0;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = a; b < 4; ++b) {
      Tensor<double>& block = blocks[pair++];
      for (std::size_t i = 0; i < 9; ++i) block[i] += weight * (w[a][i / 3] * w[b][i % 3]);
    }
  }
}
constexpr Operations kOuter = {.add_multiply = 12 * 6 + 10 * 9 * 3};

}  // namespace

Projection make_semidefinite(Blocks<double>& blocks, double support) {
  Projection result{.changed = false, .operations = kReduced + kDefinite};
  Matrix m = reduced(blocks);
  double trace = 0;
  for (std::size_t i = 0; i < kRows; ++i) trace += std::abs(m[i][i]);
  if (definite(m, std::max(support, 0x1p-24 * trace))) return result;
  result.changed = true;
  Matrix vectors{};
  for (std::size_t i = 0; i < kRows; ++i) vectors[i][i] = 1;
  const double small = 0x1p-52 * trace;
  for (int sweep = 0, turned = 1; turned > 0 && sweep < kMostSweeps; ++sweep) {
    turned = 0;
    for (std::size_t p = 0; p < kRows; ++p) {
      for (std::size_t q = p + 1; q < kRows; ++q) {
        if (std::abs(m[p][q]) <= small) continue;
        rotate(m, vectors, p, q);
        ++turned;
      }
    }
    result.operations += static_cast<double>(turned) * kRotation;
  }
  for (std::size_t k = 0; k < kRows; ++k) {
    if (!(m[k][k] < 0)) continue;
    std::array<double, kRows> v{};
    for (std::size_t i = 0; i < kRows; ++i) v[i] = vectors[i][k];
    add_outer(-m[k][k], v, blocks);
    result.operations += kOuter;
  }
  return result;
}

}  // namespace hvp::tissue
