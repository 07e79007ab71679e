#include "models/fit/tissue_newmark.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include "models/fit/tissue_response.h"
#include "models/index.h"

namespace hvp::fit {
namespace {

// A contact's node moves as it is told.
template <std::size_t Fields>
class HeldNode : private TissueNewmark<Fields> {
  using Base = TissueNewmark<Fields>;

 public:
  using Base::Base;
  using Base::positive_definite;

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
      form_rhs();
      if constexpr (Fields > 1) drive_derivatives(before);
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
  using Base::a_;
  using Base::alpha_;
  using Base::beta_;
  using Base::by_poisson_;
  using Base::by_poisson_lambda_;
  using Base::by_young_;
  using Base::factors_;
  using Base::form_rhs;
  using Base::keep_derivatives;
  using Base::material_;
  using Base::next_;
  using Base::predict;
  using Base::system_;
  using Base::u_;
  using Base::update;
  using Base::v_;

  // The contact's motion along its direction.
  struct Contact {
    double u = 0;
    double v = 0;
    double a = 0;
  };

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
};

template <std::size_t Fields>
std::optional<TissueForce> integrate(const TissueSystem& system, const TissueBody& body,
                                     const TissueValues& values, const ContactMotion& motion) {
  HeldNode<Fields> held(system, body, values);
  if (!held.positive_definite()) return std::nullopt;
  return held.run(motion);
}

}  // namespace

std::optional<TissueForce> dynamic_force(const TissueSystem& system, const TissueBody& body,
                                         const TissueValues& values, const ContactMotion& motion,
                                         bool derivatives) {
  return derivatives ? integrate<kFields>(system, body, values, motion)
                     : integrate<1>(system, body, values, motion);
}

}  // namespace hvp::fit
