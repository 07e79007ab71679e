#pragma once

#include <cmath>

#include "models/tissue/response.h"

namespace hvp::tissue {

// Neo-Hookean solids, defined where det F = J > 0: their stress keeps an element from collapsing.
// The two differ in how they take volume apart.

// ψ = μ/2·(tr C − 3) − μ·ln J + λ/2·ln²J (Bonet, Wood: Nonlinear continuum mechanics for finite
// element analysis, 2008).
struct NeoHookeanLog {
  double lambda;  // Pa
  double mu;      // Pa

  static constexpr Operations kEnergy = {.add_multiply = 38, .functions = 1};
  static constexpr Operations kStress = {.add_multiply = 61, .divisions = 1, .functions = 1};
  static constexpr Operations kTangent =
      isotropic_blocks_operations(6) +
      Operations{.add_multiply = 109, .divisions = 1, .functions = 1};

  template <class T>
  Energy<T> energy(const Tensor<T>& f) const {
    using std::log;
    const T j = determinant(f);
    if (!(j > T(0))) return {.determinant = j, .defined = false};
    const T ln = log(j);
    const T isochoric = T(0.5) * (contract(f, f) - T(3)) - ln;
    return {.density = T(mu) * isochoric + T(0.5 * lambda) * (ln * ln),
            .determinant = j,
            .operations = kEnergy};
  }

  // P = μ·(F − F⁻ᵀ) + λ·ln J·F⁻ᵀ
  template <class T>
  Stress<T> stress(const Tensor<T>& f) const {
    using std::log;
    const Tensor<T> cofactor = cofactors(f);
    const T j = determinant(f, cofactor);
    if (!(j > T(0))) return {.determinant = j, .defined = false};
    const T along = (T(lambda) * log(j) - T(mu)) / j;
    return {.p = combine(T(mu), f, along, cofactor), .determinant = j, .operations = kStress};
  }

  // K_ab = V·(λ·h_a h_bᵀ + (μ − λ·ln J)·h_b h_aᵀ + μ·(g_a·g_b)·I), h = F⁻ᵀ·g
  template <class T>
  Tangent<T> tangent(const Tensor<T>& f, const Gradients<T>& g, const T& volume,
                     Linearisation /*only one*/) const {
    using std::log;
    const Tensor<T> cofactor = cofactors(f);
    const T j = determinant(f, cofactor);
    if (!(j > T(0))) return {.determinant = j, .defined = false};
    Tangent<T> result{.determinant = j, .operations = kTangent};
    const T inverse = T(1) / j;
    Gradients<T> h;
    for (std::size_t a = 0; a < 4; ++a) {
      h[a] = apply(cofactor, g[a]);
      for (T& x : h[a]) x = inverse * x;
    }
    const T shear = T(mu) * volume;
    isotropic_blocks(
        T(lambda) * volume, volume * (T(mu) - T(lambda) * log(j)), h,
        [&](std::size_t a, std::size_t b) { return shear * dot(g[a], g[b]); }, result.blocks);
    return result;
  }
};

// ψ = μ/2·(J^(−2/3)·tr C − 3) + κ/2·(J − 1)² (Taylor, Cheng, Ourselin: High-speed nonlinear finite
// element analysis for surgical simulation using graphics processing units, 2008).
struct NeoHookeanIsochoric {
  double kappa;  // Pa
  double mu;     // Pa

  static constexpr Operations kEnergy = {.add_multiply = 38, .divisions = 1, .functions = 1};
  static constexpr Operations kStress = {.add_multiply = 82, .divisions = 2, .functions = 1};
  static constexpr Operations kTangent =
      isotropic_blocks_operations(6) +
      Operations{.add_multiply = 568, .divisions = 2, .functions = 1};

  template <class T>
  Energy<T> energy(const Tensor<T>& f) const {
    using std::cbrt;
    const T j = determinant(f);
    if (!(j > T(0))) return {.determinant = j, .defined = false};
    const T root = cbrt(j);
    const T dilatation = j - T(1);
    return {.density = T(0.5 * mu) * (contract(f, f) / (root * root) - T(3)) +
                       T(0.5 * kappa) * (dilatation * dilatation),
            .determinant = j,
            .operations = kEnergy};
  }

  // P = μ·J^(−2/3)·(F − tr C/3·F⁻ᵀ) + κ·(J − 1)·J·F⁻ᵀ
  template <class T>
  Stress<T> stress(const Tensor<T>& f) const {
    using std::cbrt;
    const Tensor<T> cofactor = cofactors(f);
    const T j = determinant(f, cofactor);
    if (!(j > T(0))) return {.determinant = j, .defined = false};
    const T root = cbrt(j);
    const T shear = T(mu) / (root * root);
    const T along = T(kappa) * (j - T(1)) - shear * contract(f, f) / (T(3) * j);
    return {.p = combine(shear, f, along, cofactor), .determinant = j, .operations = kStress};
  }

  // With s = μ·J^(−2/3), h = F⁻ᵀ·g and k = F·g,
  // K_ab = V·((2/9·s·tr C + κ·(2J − 1)·J)·h_a h_bᵀ + (s·tr C/3 − κ·(J − 1)·J)·h_b h_aᵀ
  //           + s·(g_a·g_b)·I − 2/3·s·(k_a h_bᵀ + h_a k_bᵀ))
  template <class T>
  Tangent<T> tangent(const Tensor<T>& f, const Gradients<T>& g, const T& volume,
                     Linearisation /*only one*/) const {
    using std::cbrt;
    const Tensor<T> cofactor = cofactors(f);
    const T j = determinant(f, cofactor);
    if (!(j > T(0))) return {.determinant = j, .defined = false};
    Tangent<T> result{.determinant = j, .operations = kTangent};
    const T inverse = T(1) / j;
    const T root = cbrt(j);
    const T shear = volume * (T(mu) / (root * root));
    const T third = shear * contract(f, f) * T(1.0 / 3);
    const T bulk = volume * T(kappa) * j;
    const T mixed = T(-2.0 / 3) * shear;
    Gradients<T> h;
    Gradients<T> k;  // −2/3·s·V·F·g
    for (std::size_t a = 0; a < 4; ++a) {
      h[a] = apply(cofactor, g[a]);
      k[a] = apply(f, g[a]);
      for (T& x : h[a]) x = inverse * x;
      for (T& x : k[a]) x = mixed * x;
    }
    isotropic_blocks(
        T(2.0 / 3) * third + bulk * (j + j - T(1)), third - bulk * (j - T(1)), h,
        [&](std::size_t a, std::size_t b) { return shear * dot(g[a], g[b]); }, result.blocks);
    add_pairs(k, h, result.blocks);
    return result;
  }
};

}  // namespace hvp::tissue
