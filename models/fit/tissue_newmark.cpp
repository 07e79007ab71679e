#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "models/fit/tissue_factors.h"
#include "models/fit/tissue_response.h"

namespace hvp::fit {
namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

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
        factors_(system,
                 {(1 + step_.v_of_next * beta_) * material_.value.lambda,
                  (1 + step_.v_of_next * beta_) * material_.value.mu},
                 step_.a_of_next + step_.v_of_next * alpha_) {
    const std::size_t n = index(system.unknowns());
    for (auto* state : {&u_, &v_, &a_, &v_tilde_, &a_tilde_, &next_}) state->assign(n, {});
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
  // Of the contact, along its direction.
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

  // −C·ṽ − M·ã of every field, and for the derivatives −(∂C/∂θ·u̇ + ∂K/∂θ·u) of the step before.
  void form_rhs(const Contact& before) {
    for (std::size_t i = 0; i < u_.size(); ++i) {
      FieldRow<Fields> elastic = {};  // K·ṽ
      LamePair strained;              // K_λ and K_μ times u + β·u̇
      double damped = 0;              // K·u̇
      for (std::size_t k = index(system_.row_begin[i]); k < index(system_.row_begin[i + 1]); ++k) {
        const std::size_t j = index(system_.column[k]);
        const double stiffness = combine(material_.value, system_.stiffness[k]);
        for (std::size_t f = 0; f < Fields; ++f) elastic[f] += stiffness * v_tilde_[j][f];
        if constexpr (Fields > 1) {
          const double w = u_[j][kMotion] + beta_ * v_[j][kMotion];
          strained.lambda += system_.stiffness[k].lambda * w;
          strained.mu += system_.stiffness[k].mu * w;
          damped += stiffness * v_[j][kMotion];
        }
      }
      for (std::size_t f = 0; f < Fields; ++f) next_[i][f] = -beta_ * elastic[f];
      if constexpr (Fields > 1) {
        next_[i][kYoung] -= combine(material_.by_young_modulus, strained);
        next_[i][kPoisson] -= combine(material_.by_poisson_ratio, strained);
        next_[i][kBeta] -= damped;
      }
      subtract_inertia(i);
    }
    if constexpr (Fields > 1) {
      const double w = before.u + beta_ * before.v;
      for (const TissueSystem::Coupling& to : system_.coupling) {
        FieldRow<Fields>& rhs = next_[index(to.row)];
        rhs[kYoung] -= combine(material_.by_young_modulus, to.stiffness) * w;
        rhs[kPoisson] -= combine(material_.by_poisson_ratio, to.stiffness) * w;
        rhs[kAlpha] -= to.mass * before.v;
        rhs[kBeta] -= combine(material_.value, to.stiffness) * before.v;
      }
    }
  }

  void subtract_inertia(std::size_t i) {
    const auto subtract = [&](double mass, std::size_t j) {
      for (std::size_t f = 0; f < Fields; ++f) {
        next_[i][f] -= mass * (alpha_ * v_tilde_[j][f] + a_tilde_[j][f]);
      }
      if constexpr (Fields > 1) next_[i][kAlpha] -= mass * v_[j][kMotion];
    };
    if (system_.lumped) {
      subtract(system_.diagonal[i], i);
      return;
    }
    for (std::size_t k = index(system_.row_begin[i]); k < index(system_.row_begin[i + 1]); ++k) {
      subtract(system_.mass[k], index(system_.column[k]));
    }
  }

  // What the contact does to the nodes around it.
  void drive(const Contact& now) {
    const double w = now.u + beta_ * now.v;
    const double inertia = now.a + alpha_ * now.v;
    for (const TissueSystem::Coupling& to : system_.coupling) {
      next_[index(to.row)][kMotion] -=
          combine(material_.value, to.stiffness) * w + to.mass * inertia;
    }
  }

  void update() {
    for (std::size_t i = 0; i < u_.size(); ++i) {
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
      const std::size_t i = index(to.row);
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
      const std::size_t i = index(to.row);
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
  TissueFactors factors_;
  Rows u_, v_, a_, v_tilde_, a_tilde_;
  Rows next_;  // the right-hand side, then the solution
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
