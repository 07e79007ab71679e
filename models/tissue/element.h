#pragma once

#include <array>
#include <cstddef>

#include "models/tissue/operations.h"
#include "models/tissue/tensor.h"

namespace hvp::tissue {

// The kinematics of a tetrahedron with linear interpolation, whose F is constant.

// ∇Λ of its four nodes, 1/m.
template <class T>
using Gradients = std::array<Vector<T>, 4>;

// F = I + Σ u_a·g_aᵀ from the displacements of the four nodes. The gradients' sum is zero, so that
// those of the nodes 1 to 3 suffice.
template <class T>
Tensor<T> deformation_gradient(const Gradients<T>& g, const std::array<Vector<T>, 4>& u) {
  Tensor<T> f;
  for (std::size_t i = 0; i < 3; ++i) {
    const T d1 = u[1][i] - u[0][i];
    const T d2 = u[2][i] - u[0][i];
    const T d3 = u[3][i] - u[0][i];
    for (std::size_t j = 0; j < 3; ++j) f[3 * i + j] = d1 * g[1][j] + d2 * g[2][j] + d3 * g[3][j];
    f[4 * i] = f[4 * i] + T(1);
  }
  return f;
}
inline constexpr Operations kDeformationGradient = {.add_multiply = 57};

// Adds the element's forces V·P·g_a, N, to those of its nodes. `weighted` are V·g_a, m².
template <class T>
void add_forces(const Tensor<T>& stress, const Gradients<T>& weighted,
                const std::array<T*, 4>& force) {
  for (std::size_t i = 0; i < 3; ++i) {
    T sum = T(0);
    for (std::size_t a = 1; a < 4; ++a) {
      const T f = stress[3 * i] * weighted[a][0] + stress[3 * i + 1] * weighted[a][1] +
                  stress[3 * i + 2] * weighted[a][2];
      force[a][i] = force[a][i] + f;
      sum = a == 1 ? f : sum + f;
    }
    force[0][i] = force[0][i] - sum;
  }
}
inline constexpr Operations kAddForces = {.add_multiply = 63};

// The blocks K_ab of an element with a <= b, N/m, in the order 00 01 02 03 11 12 13 22 23 33; block
// (b, a) is the transpose.
template <class T>
using Blocks = std::array<Tensor<T>, 10>;

// V·(α·h_a h_bᵀ + β·h_b h_aᵀ) + isotropic(a, b)·I, to which every isotropic law adds little. With
// h = g it is the linear block (fem::stiffness_block), bit for bit. `alpha` and `beta` have V in
// them, N·m.
template <class T, class Isotropic>
void isotropic_blocks(const T& alpha, const T& beta, const Gradients<T>& h,
                      const Isotropic& isotropic, Blocks<T>& k) {
  std::size_t block = 0;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = a; b < 4; ++b) {
      const T identity = isotropic(a, b);
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
          T entry = alpha * (h[a][i] * h[b][j]) + beta * (h[a][j] * h[b][i]);
          if (i == j) entry = entry + identity;
          k[block][3 * i + j] = entry;
        }
      }
      ++block;
    }
  }
}
// With an isotropic(a, b) of so many operations.
constexpr Operations isotropic_blocks_operations(double isotropic) {
  return {.add_multiply = 10 * (48 + isotropic)};
}

// Adds k_a q_bᵀ + q_a k_bᵀ.
template <class T>
void add_pairs(const Gradients<T>& k, const Gradients<T>& q, Blocks<T>& blocks) {
  std::size_t block = 0;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = a; b < 4; ++b) {
      Tensor<T>& one = blocks[block++];
      for (std::size_t i = 0; i < 9; ++i) {
        const std::size_t row = i / 3;
        const std::size_t column = i % 3;
        one[i] = one[i] + (k[a][row] * q[b][column] + q[a][row] * k[b][column]);
      }
    }
  }
}

}  // namespace hvp::tissue
