#pragma once

#include <cmath>

#include "models/tissue/corotational.h"
#include "models/tissue/element.h"
#include "models/tissue/fung.h"
#include "models/tissue/linear.h"
#include "models/tissue/neo_hookean.h"
#include "models/tissue/polar.h"
#include "models/tissue/st_venant_kirchhoff.h"

namespace hvp::tissue {

// Mean dilatation of a law (Simo, Taylor, Pister: Variational and projection methods for the volume
// constraint in finite deformation elasto-plasticity, 1985; of small strains, fem::Elements). Each
// law here is ψ(F) = ψ₀(F) + U(s(F)): ψ₀ is the law of a material with the same μ whose λ is zero,
// s how the law measures volume, U what λ makes of it. An element has the energy
//
//   V·(Σ_p w_p·ψ₀(F_p) + U(s̄)),  s̄ = Σ_p w_p·s(F_p)
//
// and so, with the pressure p = U'(s̄), the stress ∂ψ₀/∂F + p·∂s/∂F at each point and the tangent
// ∂²ψ₀/∂F² + p·∂²s/∂F² at each point and U''(s̄)/V·b·bᵀ, b = ∂(V·s̄)/∂u: forces of an energy, and a
// symmetric tangent. With s = J, s̄ is the element's volume over that at rest, integrated at the
// points. ψ₀ keeps the strain of each point, its change of volume included, for the reason that
// fem::Elements gives; small strains make of it the linear element.

// s at one point, and ∂s/∂F.
template <class T>
struct Dilatation {
  T s{};
  Tensor<T> gradient{};
  Operations operations = {};
};
// U at s̄ and its derivatives; it is not defined where s̄ is not above zero and the law needs that.
template <class T>
struct VolumeEnergy {
  T density{};   // U, J/m³
  T pressure{};  // U', Pa
  T modulus{};   // U'', Pa
};

namespace dilatation {

template <class T>
VolumeEnergy<T> square(double lambda, const T& strain) {
  const T pressure = T(lambda) * strain;
  return {.density = T(0.5) * (pressure * strain), .pressure = pressure, .modulus = T(lambda)};
}
inline constexpr Operations kSquare = {.add_multiply = 3};

// s = J = det F, U = λ/2·(J − 1)² unless the law says otherwise; ∂²J = J·(h_a h_bᵀ − h_b h_aᵀ) with
// h = F⁻ᵀ·g.
struct OfDeterminant {
  static constexpr Operations kMeasure = {.add_multiply = 27 + 5};
  static constexpr Operations kHessian =
      isotropic_blocks_operations(0) + Operations{.add_multiply = 4 * 15 + 1 + 90, .divisions = 1};
  static constexpr Operations kEnergy = kSquare + Operations{.add_multiply = 1};

  template <class T>
  static Dilatation<T> measure(const Tensor<T>& f) {
    const Tensor<T> cofactor = cofactors(f);
    return {.s = determinant(f, cofactor), .gradient = cofactor, .operations = kMeasure};
  }
  template <class T>
  static VolumeEnergy<T> energy(double lambda, const T& mean) {
    return square(lambda, mean - T(1));
  }
  // Adds V·p·∂²s/∂u_a∂u_b to a tangent at a point where the measure is `at`; gives its operations.
  template <class T>
  static Operations add_hessian(const Tensor<T>& /*f*/, const Dilatation<T>& at,
                                const Gradients<T>& g, const T& weighted_pressure,
                                Linearisation /*only one*/, Blocks<T>& k) {
    Gradients<T> q;
    for (std::size_t a = 0; a < 4; ++a) q[a] = apply(at.gradient, g[a]);
    const T along = weighted_pressure / at.s;
    Blocks<T> blocks;
    isotropic_blocks(
        along, T(-1) * along, q, [](std::size_t, std::size_t) { return T(0); }, blocks);
    for (std::size_t block = 0; block < blocks.size(); ++block) {
      for (std::size_t i = 0; i < 9; ++i) k[block][i] = k[block][i] + blocks[block][i];
    }
    return kHessian;
  }
};

}  // namespace dilatation

template <class Law>
struct MeanDilatation;

template <>
struct MeanDilatation<NeoHookeanIsochoric> : dilatation::OfDeterminant {};
template <>
struct MeanDilatation<Fung> : dilatation::OfDeterminant {};

// U = λ/2·ln²s, the logarithm of the mean.
template <>
struct MeanDilatation<NeoHookeanLog> : dilatation::OfDeterminant {
  static constexpr Operations kEnergy = {.add_multiply = 7, .divisions = 1, .functions = 1};

  template <class T>
  static VolumeEnergy<T> energy(double lambda, const T& mean) {
    using std::log;
    const T ln = log(mean);
    const T stress = T(lambda) * ln;
    const T inverse = T(1) / mean;
    return {.density = T(0.5) * (stress * ln),
            .pressure = stress * inverse,
            .modulus = (T(lambda) - stress) * inverse * inverse};
  }
};

// s = tr F − 3, the trace of the small strain.
template <>
struct MeanDilatation<Linear> {
  static constexpr Operations kMeasure = {.add_multiply = 3};
  static constexpr Operations kEnergy = dilatation::kSquare;

  template <class T>
  static Dilatation<T> measure(const Tensor<T>& f) {
    Dilatation<T> result{.s = trace(f) - T(3), .operations = kMeasure};
    for (std::size_t i = 0; i < 9; i += 4) result.gradient[i] = T(1);
    return result;
  }
  template <class T>
  static VolumeEnergy<T> energy(double lambda, const T& mean) {
    return dilatation::square(lambda, mean);
  }
  template <class T>
  static Operations add_hessian(const Tensor<T>& /*f*/, const Dilatation<T>& /*at*/,
                                const Gradients<T>& /*g*/, const T& /*weighted_pressure*/,
                                Linearisation /*only one*/, Blocks<T>& /*k*/) {
    return {};
  }
};

// s = tr E, the trace of Green's strain, of which ∂s/∂F is F.
template <>
struct MeanDilatation<StVenantKirchhoff> {
  static constexpr Operations kMeasure = {.add_multiply = 17 + 2};
  static constexpr Operations kEnergy = dilatation::kSquare;
  static constexpr Operations kHessian = {.add_multiply = 10 * (5 + 1 + 3)};

  template <class T>
  static Dilatation<T> measure(const Tensor<T>& f) {
    return {.s = T(0.5) * (contract(f, f) - T(3)), .gradient = f, .operations = kMeasure};
  }
  template <class T>
  static VolumeEnergy<T> energy(double lambda, const T& mean) {
    return dilatation::square(lambda, mean);
  }
  template <class T>
  static Operations add_hessian(const Tensor<T>& /*f*/, const Dilatation<T>& /*at*/,
                                const Gradients<T>& g, const T& weighted_pressure,
                                Linearisation /*only one*/, Blocks<T>& k) {
    std::size_t block = 0;
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = a; b < 4; ++b, ++block) {
        const T along = weighted_pressure * dot(g[a], g[b]);
        for (std::size_t i = 0; i < 9; i += 4) k[block][i] = k[block][i] + along;
      }
    }
    return kHessian;
  }
};

// s = tr(RᵀF) − 3, the sum of the stretches, of which ∂s/∂F is R. The warped tangent leaves out the
// change of R here too.
template <>
struct MeanDilatation<Corotational> {
  static constexpr Operations kMeasure = {.add_multiply = 17 + 1};
  static constexpr Operations kEnergy = dilatation::kSquare;
  static constexpr Operations kHessian =
      Operations{.add_multiply = 4 * 15} + Corotational::kTurning;

  template <class T>
  static Dilatation<T> measure(const Tensor<T>& f) {
    const Polar<T> polar = polar_decomposition(f);
    return {.s = contract(polar.rotation, f) - T(3),
            .gradient = polar.rotation,
            .operations = polar.operations + kMeasure};
  }
  template <class T>
  static VolumeEnergy<T> energy(double lambda, const T& mean) {
    return dilatation::square(lambda, mean);
  }
  template <class T>
  static Operations add_hessian(const Tensor<T>& f, const Dilatation<T>& at, const Gradients<T>& g,
                                const T& weighted_pressure, Linearisation linearisation,
                                Blocks<T>& k) {
    if (linearisation != Linearisation::exact) return {};
    Gradients<T> h;
    for (std::size_t a = 0; a < 4; ++a) h[a] = apply(at.gradient, g[a]);
    Corotational::add_turning(
        f, at.gradient, h, [&](const T& /*stretch*/) { return weighted_pressure; }, k);
    return kHessian;
  }
};

}  // namespace hvp::tissue
