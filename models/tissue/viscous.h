#pragma once

#include "models/tissue/corotational.h"
#include "models/tissue/element.h"
#include "models/tissue/linear.h"
#include "models/tissue/operations.h"
#include "models/tissue/tensor.h"

namespace hvp::tissue {

// Stiffness damping β of an element, in the frame in which its law sees strain:
//   P = β·A·(2μ·sym(AᵀḞ) + λ·tr(AᵀḞ)·I)
// with A = I for linear elasticity, where it is Rayleigh's β·K·v; A = R for the corotational law,
// Rayleigh's damping with the warped matrix; A = F otherwise, Kelvin and Voigt's solid of
// St Venant-Kirchhoff's moduli, S = β·ℂ:Ė. The last two do not brake a body that only turns, as
// β·K·v with the matrix at rest would.
struct Viscous {
  double lambda;  // Pa·s
  double mu;      // Pa·s

  static constexpr Operations kStress = {.add_multiply = 45 + 6 + 18 + 5 + 45};

  template <class T>
  Tensor<T> stress(const Tensor<T>& frame, const Tensor<T>& rate) const {
    Tensor<T> pulled;  // AᵀḞ
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        pulled[3 * i + j] =
            frame[i] * rate[j] + frame[3 + i] * rate[3 + j] + frame[6 + i] * rate[6 + j];
      }
    }
    const T volume = T(lambda) * trace(pulled);
    const Tensor<T> s = symmetric<T>([&](std::size_t i, std::size_t j) {
      const T shear = T(mu) * (pulled[3 * i + j] + pulled[3 * j + i]);
      return i == j ? shear + volume : shear;
    });
    return product(frame, s);
  }

  // Of add_tangent().
  static constexpr Operations kTangent = {.add_multiply = 4 * 15 + 30 + 4 + 10 * (6 + 9 * 8)};
  // ∂f_a/∂v_b, N·s/m: V·(λ·h_a h_bᵀ + μ·h_b h_aᵀ + μ·(g_a·g_b)·A·Aᵀ), h = A·g.
  template <class T>
  void add_tangent(const Tensor<T>& frame, const Gradients<T>& g, const T& volume, const T& times,
                   Blocks<T>& k) const {
    Gradients<T> h;
    for (std::size_t a = 0; a < 4; ++a) h[a] = apply(frame, g[a]);
    const Tensor<T> square = symmetric_product(frame, frame);
    const T along = times * T(lambda) * volume;
    const T shear = times * T(mu) * volume;
    std::size_t block = 0;
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = a; b < 4; ++b, ++block) {
        const T both = shear * dot(g[a], g[b]);
        for (std::size_t i = 0; i < 3; ++i) {
          for (std::size_t j = 0; j < 3; ++j) {
            k[block][3 * i + j] = k[block][3 * i + j] + along * (h[a][i] * h[b][j]) +
                                  shear * (h[a][j] * h[b][i]) + both * square[3 * i + j];
          }
        }
      }
    }
  }
};

// The elastic stress of an element and A, which the corotational law finds together.
struct Framed {
  Stress<double> stress;
  Tensor<double> frame{};
};

template <class Law>
Framed framed_stress(const Law& law, const Tensor<double>& f) {
  return {.stress = law.stress(f), .frame = f};
}

inline Framed framed_stress(const Linear& law, const Tensor<double>& f) {
  return {.stress = law.stress(f), .frame = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
}

inline Framed framed_stress(const Corotational& law, const Tensor<double>& f) {
  const Polar<double> polar = polar_decomposition(f);
  return {.stress = law.stress(f, polar), .frame = polar.rotation};
}

}  // namespace hvp::tissue
