#pragma once

#include "models/tissue/response.h"

namespace hvp::tissue {

// Linear elasticity, thesis (3.3): ψ = μ·e:e + λ/2·tr²e with e = sym(F − I). A rotation strains it.
struct Linear {
  double lambda;  // Pa
  double mu;      // Pa

  static constexpr Operations kEnergy = {.add_multiply = 38};
  static constexpr Operations kStress = {.add_multiply = 32};
  static constexpr Operations kTangent =
      isotropic_blocks_operations(6) + Operations{.add_multiply = 2 + 14};

  template <class T>
  Energy<T> energy(const Tensor<T>& f) const {
    const T xx = f[0] - T(1);
    const T yy = f[4] - T(1);
    const T zz = f[8] - T(1);
    const T xy = f[1] + f[3];
    const T xz = f[2] + f[6];
    const T yz = f[5] + f[7];
    const T tr = xx + yy + zz;
    const T square = xx * xx + yy * yy + zz * zz + T(0.5) * (xy * xy + xz * xz + yz * yz);
    return {.density = T(mu) * square + T(0.5 * lambda) * (tr * tr),
            .determinant = determinant(f),
            .operations = kEnergy};
  }

  template <class T>
  Stress<T> stress(const Tensor<T>& f) const {
    const T xx = f[0] - T(1);
    const T yy = f[4] - T(1);
    const T zz = f[8] - T(1);
    const T pressure = T(lambda) * (xx + yy + zz);
    const T xy = T(mu) * (f[1] + f[3]);
    const T xz = T(mu) * (f[2] + f[6]);
    const T yz = T(mu) * (f[5] + f[7]);
    const T twice = T(2 * mu);
    return {.p = {twice * xx + pressure, xy, xz, xy, twice * yy + pressure, yz, xz, yz,
                  twice * zz + pressure},
            .determinant = determinant(f),
            .operations = kStress};
  }

  template <class T>
  Tangent<T> tangent(const Tensor<T>& f, const Gradients<T>& g, const T& volume,
                     Linearisation /*only one*/) const {
    Tangent<T> result{.determinant = determinant(f), .operations = kTangent};
    const T shear = T(mu) * volume;
    isotropic_blocks(
        T(lambda) * volume, shear, g,
        [&](std::size_t a, std::size_t b) { return shear * dot(g[a], g[b]); }, result.blocks);
    return result;
  }
};

}  // namespace hvp::tissue
