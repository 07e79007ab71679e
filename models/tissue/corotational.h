#pragma once

#include "models/tissue/polar.h"
#include "models/tissue/response.h"

namespace hvp::tissue {

// Linear elasticity of an element that turns with it: ψ = μ·|F − R|² + λ/2·tr²(RᵀF − I), F = R·S.
// With the polar rotation its stress is the gradient of this energy, so that no work is gained
// round a loop; a rotation by another factorisation makes ghost forces (Chao, Pinkall, Sanan,
// Schröder: A simple geometric model for elastic deformations, 2010).
struct Corotational {
  double lambda;  // Pa
  double mu;      // Pa

  // Without the polar decomposition.
  static constexpr Operations kEnergy = {.add_multiply = 48};
  static constexpr Operations kStress = {.add_multiply = 47};
  static constexpr Operations kWarped =
      isotropic_blocks_operations(6) + Operations{.add_multiply = 60 + 2};
  // Of add_turning(), its factor apart.
  static constexpr Operations kTurning = {.add_multiply = 544, .divisions = 1};
  static constexpr Operations kExact =
      isotropic_blocks_operations(6) + kTurning + Operations{.add_multiply = 60 + 2 + 4};

  template <class T>
  Energy<T> energy(const Tensor<T>& f) const {
    const Polar<T> polar = polar_decomposition(f);
    const Tensor<T>& r = polar.rotation;
    T square = T(0);
    for (std::size_t i = 0; i < 9; ++i) {
      const T d = f[i] - r[i];
      square = i == 0 ? d * d : square + d * d;
    }
    const T stretch = contract(r, f) - T(3);
    return {.density = T(mu) * square + T(0.5 * lambda) * (stretch * stretch),
            .determinant = polar.determinant,
            .operations = polar.operations + kEnergy};
  }

  template <class T>
  Stress<T> stress(const Tensor<T>& f) const {
    return stress(f, polar_decomposition(f));
  }
  template <class T>
  Stress<T> stress(const Tensor<T>& f, const Polar<T>& polar) const {
    const T twice = T(2 * mu);
    const T along = T(lambda) * (contract(polar.rotation, f) - T(3)) - twice;
    return {.p = combine(twice, f, along, polar.rotation),
            .determinant = polar.determinant,
            .operations = polar.operations + kStress};
  }

  // The warped one is V·(λ·h_a h_bᵀ + μ·h_b h_aᵀ + μ·(g_a·g_b)·I), h = R·g. The exact one has the
  // change of R as well, V·(λ·h_a h_bᵀ + 2μ·(g_a·g_b)·I + c·[h_a]ᵀ·D⁻¹·[h_b]) with
  // c = λ·(tr S − 3) − 2μ, D = tr S·I − F·Rᵀ and [h]x = h × x. D is singular where the two smaller
  // singular values, one of them negated, cancel: R jumps there, and the tangent is not finite.
  template <class T>
  Tangent<T> tangent(const Tensor<T>& f, const Gradients<T>& g, const T& volume,
                     Linearisation linearisation) const {
    const Polar<T> polar = polar_decomposition(f);
    const Tensor<T>& r = polar.rotation;
    Tangent<T> result{.determinant = polar.determinant, .operations = polar.operations};
    Gradients<T> h;
    for (std::size_t a = 0; a < 4; ++a) h[a] = apply(r, g[a]);
    const bool exact = linearisation == Linearisation::exact;
    const T shear = T(exact ? 2 * mu : mu) * volume;
    isotropic_blocks(
        T(lambda) * volume, exact ? T(0) : shear, h,
        [&](std::size_t a, std::size_t b) { return shear * dot(g[a], g[b]); }, result.blocks);
    if (exact) {
      add_turning(
          f, r, h,
          [&](const T& stretch) { return volume * (T(lambda) * (stretch - T(3)) - T(2 * mu)); },
          result.blocks);
    }
    result.operations += exact ? kExact : kWarped;
    return result;
  }

  // Adds c·[h_a]ᵀ·D⁻¹·[h_b], the change of R, where c, with the volume in it, is a function of tr
  // S.
  template <class T, class Factor>
  static void add_turning(const Tensor<T>& f, const Tensor<T>& r, const Gradients<T>& h,
                          const Factor& factor, Blocks<T>& k) {
    Tensor<T> d = symmetric_product(f, r);
    const T stretch = trace(d);
    for (std::size_t i = 0; i < 9; ++i) d[i] = i % 4 == 0 ? stretch - d[i] : -d[i];
    const Tensor<T> cofactor = cofactors(d);
    const T scale = factor(stretch) / determinant(d, cofactor);
    Tensor<T> n;  // V·c·D⁻¹, symmetric
    for (std::size_t i = 0; i < 9; ++i) n[i] = scale * cofactor[i];

    std::array<Tensor<T>, 4> turned{};  // N·[h_b]: row i is row i of N, × h_b
    for (std::size_t b = 0; b < 4; ++b) {
      for (std::size_t i = 0; i < 3; ++i) {
        const Vector<T> row = cross({n[3 * i], n[3 * i + 1], n[3 * i + 2]}, h[b]);
        for (std::size_t j = 0; j < 3; ++j) turned[b][3 * i + j] = row[j];
      }
    }
    std::size_t block = 0;
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = a; b < 4; ++b) {
        const Tensor<T>& m = turned[b];
        for (std::size_t j = 0; j < 3; ++j) {
          const Vector<T> column = cross({m[j], m[3 + j], m[6 + j]}, h[a]);
          for (std::size_t i = 0; i < 3; ++i) {
            k[block][3 * i + j] = k[block][3 * i + j] + column[i];
          }
        }
        // Both triangles of a node's own block are the same to the last bit.
        if (a == b) {
          Tensor<T>& own = k[block];
          own[3] = own[1];
          own[6] = own[2];
          own[7] = own[5];
        }
        ++block;
      }
    }
  }
};

}  // namespace hvp::tissue
