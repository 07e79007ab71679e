#pragma once

#include "models/tissue/response.h"

namespace hvp::tissue {

// ψ = μ·E:E + λ/2·tr²E with Green's strain E = (FᵀF − I)/2. A rotation does not strain it, but it
// grows softer under compression, without a limit that would keep it from being turned inside out.
struct StVenantKirchhoff {
  double lambda;  // Pa
  double mu;      // Pa

  static constexpr Operations kEnergy = {.add_multiply = 65};
  static constexpr Operations kStress = {.add_multiply = 104};
  static constexpr Operations kTangent =
      isotropic_blocks_operations(6) + Operations{.add_multiply = 451};

  template <class T>
  Energy<T> energy(const Tensor<T>& f) const {
    const Tensor<T> c = right_cauchy_green(f);
    const T xx = c[0] - T(1);
    const T yy = c[4] - T(1);
    const T zz = c[8] - T(1);
    const T tr = xx + yy + zz;
    const T square = xx * xx + yy * yy + zz * zz + T(2) * (c[1] * c[1] + c[2] * c[2] + c[5] * c[5]);
    return {.density = T(0.25 * mu) * square + T(0.125 * lambda) * (tr * tr),
            .determinant = determinant(f),
            .operations = kEnergy};
  }

  template <class T>
  Stress<T> stress(const Tensor<T>& f) const {
    return {
        .p = product(f, second_stress(f)), .determinant = determinant(f), .operations = kStress};
  }

  // K_ab = V·(λ·h_a h_bᵀ + μ·h_b h_aᵀ + μ·(g_a·g_b)·F·Fᵀ + (g_a·S·g_b)·I), h = F·g, S = 2μE + λ
  // trE.
  template <class T>
  Tangent<T> tangent(const Tensor<T>& f, const Gradients<T>& g, const T& volume,
                     Linearisation /*only one*/) const {
    Tangent<T> result{.determinant = determinant(f), .operations = kTangent};
    const Tensor<T> s = second_stress(f);
    const Tensor<T> left = symmetric_product(f, f);
    Gradients<T> h;
    Gradients<T> weighted;
    for (std::size_t a = 0; a < 4; ++a) {
      h[a] = apply(f, g[a]);
      weighted[a] = apply(s, g[a]);
    }
    const T shear = T(mu) * volume;
    isotropic_blocks(
        T(lambda) * volume, shear, h,
        [&](std::size_t a, std::size_t b) { return volume * dot(weighted[a], g[b]); },
        result.blocks);
    std::size_t block = 0;
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = a; b < 4; ++b) {
        const T along = shear * dot(g[a], g[b]);
        Tensor<T>& k = result.blocks[block++];
        for (std::size_t i = 0; i < 9; ++i) k[i] = k[i] + along * left[i];
      }
    }
    return result;
  }

 private:
  // S = 2μE + λ·tr E·I, the second Piola-Kirchhoff stress, Pa.
  template <class T>
  Tensor<T> second_stress(const Tensor<T>& f) const {
    Tensor<T> s = right_cauchy_green(f);
    const T xx = s[0] - T(1);
    const T yy = s[4] - T(1);
    const T zz = s[8] - T(1);
    const T pressure = T(0.5 * lambda) * (xx + yy + zz);
    s[0] = T(mu) * xx + pressure;
    s[4] = T(mu) * yy + pressure;
    s[8] = T(mu) * zz + pressure;
    s[1] = s[3] = T(mu) * s[1];
    s[2] = s[6] = T(mu) * s[2];
    s[5] = s[7] = T(mu) * s[5];
    return s;
  }
};

}  // namespace hvp::tissue
