#pragma once

#include <array>
#include <cstddef>

namespace hvp::tissue {

// Vectors and 3 × 3 tensors of the kernels below, a tensor row by row. They are templates because
// a test computes with numbers that count their own operations (tests/tissue/counted.h); each sum
// is written out, so that its order does not depend on a library or a compiler.
template <class T>
using Vector = std::array<T, 3>;
template <class T>
using Tensor = std::array<T, 9>;

template <class T>
T dot(const Vector<T>& a, const Vector<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class T>
Vector<T> cross(const Vector<T>& a, const Vector<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <class T>
Vector<T> apply(const Tensor<T>& a, const Vector<T>& x) {
  return {a[0] * x[0] + a[1] * x[1] + a[2] * x[2], a[3] * x[0] + a[4] * x[1] + a[5] * x[2],
          a[6] * x[0] + a[7] * x[1] + a[8] * x[2]};
}

// A:B, the sum of the products of their entries.
template <class T>
T contract(const Tensor<T>& a, const Tensor<T>& b) {
  T sum = a[0] * b[0];
  for (std::size_t i = 1; i < 9; ++i) sum = sum + a[i] * b[i];
  return sum;
}

template <class T>
T trace(const Tensor<T>& a) {
  return a[0] + a[4] + a[8];
}

// a·A + b·B
template <class T, class A, class B>
Tensor<T> combine(const A& a, const Tensor<T>& first, const B& b, const Tensor<T>& second) {
  Tensor<T> sum;
  for (std::size_t i = 0; i < 9; ++i) sum[i] = a * first[i] + b * second[i];
  return sum;
}

// The cofactors: det F·F⁻ᵀ, without a division.
template <class T>
Tensor<T> cofactors(const Tensor<T>& f) {
  return {f[4] * f[8] - f[5] * f[7], f[5] * f[6] - f[3] * f[8], f[3] * f[7] - f[4] * f[6],
          f[2] * f[7] - f[1] * f[8], f[0] * f[8] - f[2] * f[6], f[1] * f[6] - f[0] * f[7],
          f[1] * f[5] - f[2] * f[4], f[2] * f[3] - f[0] * f[5], f[0] * f[4] - f[1] * f[3]};
}

// det F of a tensor and its cofactors.
template <class T>
T determinant(const Tensor<T>& f, const Tensor<T>& cofactor) {
  return f[0] * cofactor[0] + f[1] * cofactor[1] + f[2] * cofactor[2];
}

// det F where nobody needs the cofactors.
template <class T>
T determinant(const Tensor<T>& f) {
  return f[0] * (f[4] * f[8] - f[5] * f[7]) + f[1] * (f[5] * f[6] - f[3] * f[8]) +
         f[2] * (f[3] * f[7] - f[4] * f[6]);
}

// A symmetric tensor from its upper triangle, entry (i, j) given by `entry`.
template <class T, class Entry>
Tensor<T> symmetric(const Entry& entry) {
  Tensor<T> s;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i; j < 3; ++j) s[3 * i + j] = s[3 * j + i] = entry(i, j);
  }
  return s;
}

// C = FᵀF, the right Cauchy-Green tensor.
template <class T>
Tensor<T> right_cauchy_green(const Tensor<T>& f) {
  return symmetric<T>([&f](std::size_t i, std::size_t j) {
    return f[i] * f[j] + f[3 + i] * f[3 + j] + f[6 + i] * f[6 + j];
  });
}

// A·Bᵀ where it is known to be symmetric.
template <class T>
Tensor<T> symmetric_product(const Tensor<T>& a, const Tensor<T>& b) {
  return symmetric<T>([&a, &b](std::size_t i, std::size_t j) {
    return a[3 * i] * b[3 * j] + a[3 * i + 1] * b[3 * j + 1] + a[3 * i + 2] * b[3 * j + 2];
  });
}

template <class T>
Tensor<T> product(const Tensor<T>& a, const Tensor<T>& b) {
  Tensor<T> p;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      p[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
    }
  }
  return p;
}

}  // namespace hvp::tissue
