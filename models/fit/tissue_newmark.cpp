#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "models/fit/tissue_factors.h"
#include "models/fit/tissue_response.h"
#include "models/index.h"

namespace hvp::fit {
namespace {

// Field 0 is the body's motion, the others its derivatives by E, ν, α, β.
enum Field : std::size_t { kMotion, kYoung, kPoisson, kAlpha, kBeta, kFields };

// Newmark's rule for all fields together. A derivative is driven by the motion that the same step
// has found; so that one pass over the factors serves all, derivatives are a step behind.
template <std::size_t Fields>
class Integration {
 public:
  Integration(const TissueSystem& system, const TissueBody& body, const TissueValues& values)
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

  TissueForce run(const ContactMotion& motion) {
    const std::size_t samples = motion.displacement.size();
    // The last round is for the derivatives alone.
    const std::size_t rounds = Fields == 1 ? samples : samples + 1;
    TissueForce result;
    Contact before;
    for (std::size_t i = 0; i < rounds; ++i) {
      const std::size_t at = std::min(i, samples - 1);
      const Contact now{motion.displacement[at], motion.velocity[at], motion.acceleration[at]};
      predict();
      form_rhs(before);
      drive(now);
      FieldRow<Fields> force = {};
      if constexpr (Fields > 1) add_explicit(before, force);
      factors_.solve(next_);
      update();
      add_reaction(now, force);
      if (i < samples) result.force.push_back(force[kMotion]);
      if constexpr (Fields > 1) {
        if (i > 0) keep_derivatives(force, result);
      }
      before = now;
    }
    return result;
  }

 private:
  // The contact's motion along its direction.
  struct Contact {
    double u = 0;
    double v = 0;
    double a = 0;
  };

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
  void form_rhs(const Contact& before) {
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
    if constexpr (Fields > 1) drive_derivatives(before);
  }

  void drive_derivatives(const Contact& before) {
    const double w = before.u + beta_ * before.v;
    const double inertia = before.a + alpha_ * before.v;
    for (const TissueSystem::Coupling& to : system_.coupling) {
      FieldRow<Fields>& rhs = next_[at(to.row)];
      rhs[kYoung] += by_young_ * to.mass * inertia;
      rhs[kPoisson] +=
          by_poisson_ * to.mass * inertia - by_poisson_lambda_ * to.stiffness.lambda * w;
      rhs[kAlpha] -= to.mass * before.v;
      rhs[kBeta] -= combine(material_.value, to.stiffness) * before.v;
    }
  }

  // The contact's effect on the nodes around it.
  void drive(const Contact& now) {
    const double w = now.u + beta_ * now.v;
    const double inertia = now.a + alpha_ * now.v;
    for (const TissueSystem::Coupling& to : system_.coupling) {
      next_[at(to.row)][kMotion] -= combine(material_.value, to.stiffness) * w + to.mass * inertia;
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

  // M·ü + C·u̇ + K·u in the contact's row.
  void add_reaction(const Contact& now, FieldRow<Fields>& force) const {
    force[kMotion] +=
        combine(material_.value, system_.contact_stiffness) * (now.u + beta_ * now.v) +
        system_.contact_mass * (now.a + alpha_ * now.v);
    for (const TissueSystem::Coupling& to : system_.coupling) {
      const std::size_t i = at(to.row);
      const double stiffness = combine(material_.value, to.stiffness);
      for (std::size_t f = 0; f < Fields; ++f) {
        force[f] +=
            stiffness * (u_[i][f] + beta_ * v_[i][f]) + to.mass * (a_[i][f] + alpha_ * v_[i][f]);
      }
    }
  }

  // The contact's row of ∂C/∂θ·u̇ + ∂K/∂θ·u in the step before, whose motion is still there.
  void add_explicit(const Contact& before, FieldRow<Fields>& force) const {
    const double w_contact = before.u + beta_ * before.v;
    LamePair strained{system_.contact_stiffness.lambda * w_contact,
                      system_.contact_stiffness.mu * w_contact};
    LamePair moved{system_.contact_stiffness.lambda * before.v,
                   system_.contact_stiffness.mu * before.v};
    double momentum = system_.contact_mass * before.v;
    for (const TissueSystem::Coupling& to : system_.coupling) {
      const std::size_t i = at(to.row);
      const double w = u_[i][kMotion] + beta_ * v_[i][kMotion];
      strained.lambda += to.stiffness.lambda * w;
      strained.mu += to.stiffness.mu * w;
      moved.lambda += to.stiffness.lambda * v_[i][kMotion];
      moved.mu += to.stiffness.mu * v_[i][kMotion];
      momentum += to.mass * v_[i][kMotion];
    }
    force[kYoung] += combine(material_.by_young_modulus, strained);
    force[kPoisson] += combine(material_.by_poisson_ratio, strained);
    force[kAlpha] += momentum;
    force[kBeta] += combine(material_.value, moved);
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

template <std::size_t Fields>
std::optional<TissueForce> integrate(const TissueSystem& system, const TissueBody& body,
                                     const TissueValues& values, const ContactMotion& motion) {
  Integration<Fields> integration(system, body, values);
  if (!integration.positive_definite()) return std::nullopt;
  return integration.run(motion);
}

}  // namespace

std::optional<TissueForce> dynamic_force(const TissueSystem& system, const TissueBody& body,
                                         const TissueValues& values, const ContactMotion& motion,
                                         bool derivatives) {
  return derivatives ? integrate<kFields>(system, body, values, motion)
                     : integrate<1>(system, body, values, motion);
}

}  // namespace hvp::fit
