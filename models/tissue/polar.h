#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "models/tissue/operations.h"
#include "models/tissue/tensor.h"

namespace hvp::tissue {

// F = R·S: R is the rotation, det R = +1, that is nearest to F, which is the one of the largest
// trace of RᵀF. Where det F < 0 the smallest singular value is then negative in S (Irving,
// Teran, Fedkiw: Invertible finite elements, 2004).
template <class T>
struct Polar {
  Tensor<T> rotation{};
  T determinant{};             // det F
  Operations operations = {};  // of this decomposition, det F included
};

namespace polar {

// Newton's iteration X ← ½·(X + X⁻ᵀ) doubles its digits once the singular values are near one, and
// halves the smallest one's reciprocal before. Below this det F an element is flat or inverted, and
// the eigenvector takes over.
inline constexpr double kNewtonFrom = 0.01;
// After a step every singular value is 1 + e with e >= 0, so that det X − 1 is the sum of all e.
// The next step leaves e²/2, less than one rounding.
inline constexpr double kLastStep = 1e-8;
inline constexpr int kMostSteps = 60;

inline constexpr Operations kNewtonStep = {.add_multiply = 59, .divisions = 1};

inline constexpr int kMostSweeps = 20;
inline constexpr double kOffDiagonal = 1e-34;  // of the squared norm: a hundredth of a rounding
inline constexpr Operations kForm = {.add_multiply = 51 + 32};  // and det F
inline constexpr Operations kSweep = {.add_multiply = 12};
inline constexpr Operations kRotate = {.add_multiply = 80, .divisions = 3, .functions = 2};
inline constexpr Operations kFromQuaternion = {.add_multiply = 46, .divisions = 1};

template <class T>
using Matrix4 = std::array<std::array<T, 4>, 4>;

// One of Jacobi's rotations, which clears entry (p, q) of the symmetric `b` and turns the
// eigenvectors in the columns of `v`.
template <class T>
void rotate(Matrix4<T>& b, Matrix4<T>& v, std::size_t p, std::size_t q) {
  using std::sqrt;
  const T theta = (b[q][q] - b[p][p]) / (b[p][q] + b[p][q]);
  const T root = sqrt(theta * theta + T(1));
  const T t = theta < T(0) ? T(-1) / (root - theta) : T(1) / (root + theta);
  const T c = T(1) / sqrt(t * t + T(1));
  const T s = t * c;
  const auto turn = [&c, &s](T& x, T& y) {
    const T kept = x;
    x = c * kept - s * y;
    y = s * kept + c * y;
  };
  for (std::size_t k = 0; k < 4; ++k) turn(b[k][p], b[k][q]);
  for (std::size_t k = 0; k < 4; ++k) turn(b[p][k], b[q][k]);
  for (std::size_t k = 0; k < 4; ++k) turn(v[k][p], v[k][q]);
  b[p][q] = b[q][p] = T(0);
}

// The rotation of the unit quaternion that is the eigenvector of the largest eigenvalue of a
// symmetric matrix linear in F, as Higham and Noferini form it (An algorithm to compute the polar
// decomposition of a 3 × 3 matrix, 2016); by Jacobi's rotations, for any F.
template <class T>
Polar<T> by_eigenvector(const Tensor<T>& f, const T& det) {
  const T diagonal = f[4] + f[8];
  const T difference = f[4] - f[8];
  Matrix4<T> b = {{{f[0] + diagonal, f[7] - f[5], f[2] - f[6], f[3] - f[1]},
                   {f[7] - f[5], f[0] - diagonal, f[1] + f[3], f[2] + f[6]},
                   {f[2] - f[6], f[1] + f[3], difference - f[0], f[5] + f[7]},
                   {f[3] - f[1], f[2] + f[6], f[5] + f[7], -difference - f[0]}}};
  Matrix4<T> v{};
  T norm = T(0);
  for (std::size_t i = 0; i < 4; ++i) {
    v[i][i] = T(1);
    for (std::size_t j = 0; j < 4; ++j) norm = norm + b[i][j] * b[i][j];
  }
  const T small = T(kOffDiagonal) * norm;

  Polar<T> result;
  result.determinant = det;
  result.operations = kForm + kFromQuaternion;
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    T rest = T(0);
    for (std::size_t p = 0; p < 4; ++p) {
      for (std::size_t q = p + 1; q < 4; ++q) rest = rest + b[p][q] * b[p][q];
    }
    result.operations += kSweep;
    if (!(rest > small)) break;
    for (std::size_t p = 0; p < 4; ++p) {
      for (std::size_t q = p + 1; q < 4; ++q) {
        if (b[p][q] == T(0)) continue;
        rotate(b, v, p, q);
        result.operations += kRotate;
      }
    }
  }

  std::size_t largest = 0;
  for (std::size_t i = 1; i < 4; ++i) {
    if (b[largest][largest] < b[i][i]) largest = i;
  }
  const T w = v[0][largest];
  const T x = v[1][largest];
  const T y = v[2][largest];
  const T z = v[3][largest];
  // Divided by |q|², the matrix is a rotation to rounding though q has unit length only nearly.
  const T two = T(2) / (w * w + x * x + y * y + z * z);
  result.rotation = {
      T(1) - two * (y * y + z * z), two * (x * y - w * z),        two * (x * z + w * y),
      two * (x * y + w * z),        T(1) - two * (x * x + z * z), two * (y * z - w * x),
      two * (x * z - w * y),        two * (y * z + w * x),        T(1) - two * (x * x + y * y)};
  return result;
}

}  // namespace polar

template <class T>
Polar<T> polar_decomposition(const Tensor<T>& f) {
  Polar<T> result;
  result.rotation = f;
  Tensor<T>& x = result.rotation;
  for (int step = 0; step < polar::kMostSteps; ++step) {
    const Tensor<T> cofactor = cofactors(x);
    const T det = determinant(x, cofactor);
    if (step == 0) {
      result.determinant = det;
      if (!(det > T(polar::kNewtonFrom))) return polar::by_eigenvector(f, det);
    }
    const T half = T(0.5) / det;
    x = combine(T(0.5), x, half, cofactor);
    result.operations += polar::kNewtonStep;
    if (step > 0 && det < T(1 + polar::kLastStep)) break;
  }
  return result;
}

}  // namespace hvp::tissue
