#pragma once

#include <cmath>

#include "models/tissue/response.h"

namespace hvp::tissue {

// A solid that stiffens exponentially, ψ = μ/(2b)·(e^(b·(Ī₁ − 3)) − 1) + κ/2·(J − 1)² with
// Ī₁ = J^(−2/3)·tr C (Demiray: A note on the elasticity of soft biological tissues, 1972, after
// Fung: Elasticity of soft tissues in simple elongation, 1967; the volume as in
// NeoHookeanIsochoric, to which it tends as b falls to zero). It is defined where J > 0 and where
// the exponent is not above kLargestExponent.
struct Fung {
  double kappa;  // Pa
  double mu;     // Pa
  double b;      // at least kLeastB

  // A b of zero is taken for this one: what it does to a stress is far below rounding, and no
  // formula needs another form for zero.
  static constexpr double kLeastB = 1e-100;
  // Tissue has failed long before, and e to it times any modulus is a finite number.
  static constexpr double kLargestExponent = 200;

  static constexpr Operations kEnergy = {.add_multiply = 40, .divisions = 1, .functions = 2};
  static constexpr Operations kStress = {.add_multiply = 87, .divisions = 2, .functions = 2};
  static constexpr Operations kTangent =
      isotropic_blocks_operations(6) +
      Operations{.add_multiply = 604, .divisions = 2, .functions = 2};

  template <class T>
  Energy<T> energy(const Tensor<T>& f) const {
    using std::cbrt;
    using std::expm1;
    const T j = determinant(f);
    if (!(j > T(0))) return {.determinant = j, .defined = false};
    const T root = cbrt(j);
    const T scale = T(1) / (root * root);
    const T exponent = T(b) * (scale * contract(f, f) - T(3));
    if (!(exponent < T(kLargestExponent))) return {.determinant = j, .defined = false};
    const T dilatation = j - T(1);
    return {
        .density = T(0.5 * mu / b) * expm1(exponent) + T(0.5 * kappa) * (dilatation * dilatation),
        .determinant = j,
        .operations = kEnergy};
  }

  // P = s·(F − tr C/3·F⁻ᵀ) + κ·(J − 1)·J·F⁻ᵀ, s = μ·e^(b·(Ī₁ − 3))·J^(−2/3)
  template <class T>
  Stress<T> stress(const Tensor<T>& f) const {
    using std::cbrt;
    using std::exp;
    const Tensor<T> cofactor = cofactors(f);
    const T j = determinant(f, cofactor);
    if (!(j > T(0))) return {.determinant = j, .defined = false};
    const T root = cbrt(j);
    const T scale = T(1) / (root * root);
    const T square = contract(f, f);
    const T exponent = T(b) * (scale * square - T(3));
    if (!(exponent < T(kLargestExponent))) return {.determinant = j, .defined = false};
    const T shear = T(mu) * exp(exponent) * scale;
    const T along = T(kappa) * (j - T(1)) - shear * square / (T(3) * j);
    return {.p = combine(shear, f, along, cofactor), .determinant = j, .operations = kStress};
  }

  // With h = F⁻ᵀ·g, k = F·g, t = tr C/3 and n = 2b·s·J^(−2/3), which is the change of s,
  // K_ab = V·((2/3·s·t + n·t² + κ·(2J − 1)·J)·h_a h_bᵀ + (s·t − κ·(J − 1)·J)·h_b h_aᵀ
  //           + s·(g_a·g_b)·I − (2/3·s + n·t)·(k_a h_bᵀ + h_a k_bᵀ) + n·k_a k_bᵀ)
  template <class T>
  Tangent<T> tangent(const Tensor<T>& f, const Gradients<T>& g, const T& volume,
                     Linearisation /*only one*/) const {
    using std::cbrt;
    using std::exp;
    const Tensor<T> cofactor = cofactors(f);
    const T j = determinant(f, cofactor);
    if (!(j > T(0))) return {.determinant = j, .defined = false};
    const T root = cbrt(j);
    const T scale = T(1) / (root * root);
    const T square = contract(f, f);
    const T exponent = T(b) * (scale * square - T(3));
    if (!(exponent < T(kLargestExponent))) return {.determinant = j, .defined = false};
    Tangent<T> result{.determinant = j, .operations = kTangent};
    const T inverse = T(1) / j;
    const T shear = volume * (T(mu) * exp(exponent) * scale);
    const T third = square * T(1.0 / 3);
    const T grown = T(b) * scale * shear;  // n/2
    const T bulk = volume * T(kappa) * j;
    const T pressed = shear * third;
    const T stiffened = (grown + grown) * third;
    const T mixed = T(-2.0 / 3) * shear - stiffened;
    Gradients<T> h;
    Gradients<T> k;
    Gradients<T> q;  // the two sums of k and h in one
    for (std::size_t a = 0; a < 4; ++a) {
      h[a] = apply(cofactor, g[a]);
      k[a] = apply(f, g[a]);
      for (std::size_t i = 0; i < 3; ++i) {
        h[a][i] = inverse * h[a][i];
        q[a][i] = mixed * h[a][i] + grown * k[a][i];
      }
    }
    isotropic_blocks(
        T(2.0 / 3) * pressed + stiffened * third + bulk * (j + j - T(1)),
        pressed - bulk * (j - T(1)), h,
        [&](std::size_t a, std::size_t c) { return shear * dot(g[a], g[c]); }, result.blocks);
    add_pairs(k, q, result.blocks);
    return result;
  }
};

}  // namespace hvp::tissue
