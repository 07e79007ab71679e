#pragma once

#include <cstddef>
#include <vector>

#include "models/fem/newmark.h"
#include "models/fit/tissue_factors.h"
#include "models/fit/tissue_response.h"
#include "models/fit/tissue_system.h"
#include "models/index.h"

namespace hvp::fit {

// Field 0 is the body's motion, the others its derivatives by E, ν, α, β.
enum TissueField : std::size_t { kMotion, kYoung, kPoisson, kAlpha, kBeta, kFields };

// Newmark's rule for all fields together. A derivative is driven by the motion that the same step
// has found; so that one pass over the factors serves all, derivatives are a step behind. What
// touches the body is added by the classes that derive from this one.
template <std::size_t Fields>
class TissueNewmark {
 public:
  TissueNewmark(const TissueSystem& system, const TissueBody& body, const TissueValues& values)
      : system_(system),
        material_(lame(values.young_modulus, values.poisson_ratio)),
        alpha_(values.mass_damping),
        beta_(values.stiffness_damping),
        step_(*body.dynamics, body.period_s),
        of_stiffness_(1 + step_.v_of_next * beta_),
        of_mass_(step_.a_of_next + step_.v_of_next * alpha_),
        factors_(system,
                 {of_stiffness_ * material_.value.lambda, of_stiffness_ * material_.value.mu},
                 of_mass_) {
    const std::size_t n = at(system.unknowns());
    for (auto* state : {&u_, &v_, &a_, &v_tilde_, &a_tilde_, &momentum_, &next_})
      state->assign(n, {});
  }

  bool positive_definite() const { return factors_.positive_definite(); }

 protected:
  // Factors of (3.25) and (3.26), as in fem::Newmark.
  struct Step {
    Step(const fem::Dynamics& rule, double h)
        : a_of_next(2 / (rule.newmark_beta * h * h)),
          v_of_next(2 * rule.newmark_gamma / (rule.newmark_beta * h)),
          a_of_v(-2 / (rule.newmark_beta * h)),
          a_of_a(-(1 - rule.newmark_beta) / rule.newmark_beta),
          v_of_v(1 - 2 * rule.newmark_gamma / rule.newmark_beta),
          v_of_a((1 - rule.newmark_gamma / rule.newmark_beta) * h) {}
    double a_of_next, v_of_next, a_of_v, a_of_a, v_of_v, v_of_a;
  };

  using Rows = std::vector<FieldRow<Fields>>;

  void predict() {
    for (std::size_t i = 0; i < u_.size(); ++i) {
      for (std::size_t f = 0; f < Fields; ++f) {
        a_tilde_[i][f] =
            -step_.a_of_next * u_[i][f] + step_.a_of_v * v_[i][f] + step_.a_of_a * a_[i][f];
        v_tilde_[i][f] =
            -step_.v_of_next * u_[i][f] + step_.v_of_v * v_[i][f] + step_.v_of_a * a_[i][f];
      }
    }
  }

  // The vector that M multiplies in the right-hand sides of y; see form_rhs().
  FieldRow<Fields> momentum(std::size_t i) const {
    FieldRow<Fields> p = {};
    const double share = beta_ * of_mass_ / of_stiffness_ - alpha_;
    for (std::size_t f = 0; f < Fields; ++f) p[f] = share * v_tilde_[i][f] - a_tilde_[i][f];
    if constexpr (Fields > 1) {
      const double inertia = a_[i][kMotion] + alpha_ * v_[i][kMotion];
      p[kYoung] += by_young_ * inertia;
      p[kPoisson] += by_poisson_ * inertia;
      p[kAlpha] -= v_[i][kMotion];
      p[kBeta] += of_mass_ / of_stiffness_ * v_[i][kMotion];
    }
    return p;
  }

  // Â = κ·K + m·M. No product with K is needed:
  //   motion       u = y − β/κ·ṽ turns Â·u = −β·K·ṽ − M·(α·ṽ + ã) into
  //                Â·y = M·((β·m/κ − α)·ṽ − ã); likewise the derivatives, whose right-hand sides
  //                are those of the step before, driven by
  //   E            −K/E·(u + β·u̇), which is M·(ü + α·u̇)/E by the equation of motion;
  //   ν            −(λ'·K_λ + μ'·K_μ)·(u + β·u̇): as E with μ'/μ for 1/E, and the rest of K_λ;
  //   α            −M·u̇;
  //   β            −K·u̇, by another u̇/κ taken from y.
  void form_rhs() {
    for (std::size_t i = 0; i < u_.size(); ++i) momentum_[i] = momentum(i);
    for (std::size_t i = 0; i < u_.size(); ++i) {
      FieldRow<Fields>& rhs = next_[i];
      rhs = {};
      const auto add = [&](double mass, const FieldRow<Fields>& of) {
        for (std::size_t f = 0; f < Fields; ++f) rhs[f] += mass * of[f];
      };
      if (system_.lumped) add(system_.diagonal[i], momentum_[i]);
      double strained = 0;  // K_λ·(u + β·u̇)
      for (std::size_t k = at(system_.row_begin[i]); k < at(system_.row_begin[i + 1]); ++k) {
        const std::size_t j = at(system_.column[k]);
        if (!system_.lumped) add(system_.mass[k], momentum_[j]);
        if constexpr (Fields > 1) {
          strained += system_.stiffness[k].lambda * (u_[j][kMotion] + beta_ * v_[j][kMotion]);
        }
      }
      if constexpr (Fields > 1) rhs[kPoisson] -= by_poisson_lambda_ * strained;
    }
  }

  // From y to u, and the rest of (3.25).
  void update() {
    for (std::size_t i = 0; i < u_.size(); ++i) {
      for (std::size_t f = 0; f < Fields; ++f) {
        next_[i][f] -= beta_ / of_stiffness_ * v_tilde_[i][f];
      }
      if constexpr (Fields > 1) next_[i][kBeta] -= v_[i][kMotion] / of_stiffness_;
      for (std::size_t f = 0; f < Fields; ++f) {
        u_[i][f] = next_[i][f];
        a_[i][f] = a_tilde_[i][f] + step_.a_of_next * next_[i][f];
        v_[i][f] = v_tilde_[i][f] + step_.v_of_next * next_[i][f];
      }
    }
  }

  static void keep_derivatives(const FieldRow<Fields>& force, TissueForce& result) {
    result.by_young_modulus.push_back(force[kYoung]);
    result.by_poisson_ratio.push_back(force[kPoisson]);
    result.by_mass_damping.push_back(force[kAlpha]);
    result.by_stiffness_damping.push_back(force[kBeta]);
  }

  const TissueSystem& system_;
  Lame material_;
  double alpha_;
  double beta_;
  Step step_;
  double of_stiffness_;  // κ
  double of_mass_;       // m, 1/s²
  TissueFactors factors_;
  // ∂K/∂E = by_young·K, ∂K/∂ν = by_poisson·K + by_poisson_lambda·K_λ.
  double by_young_ = material_.by_young_modulus.mu / material_.value.mu;
  double by_poisson_ = material_.by_poisson_ratio.mu / material_.value.mu;
  double by_poisson_lambda_ =
      material_.by_poisson_ratio.lambda - by_poisson_ * material_.value.lambda;
  Rows u_, v_, a_, v_tilde_, a_tilde_;
  Rows momentum_;
  Rows next_;  // the right-hand side, y, then u
};

}  // namespace hvp::fit
