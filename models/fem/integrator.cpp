#include "models/fem/integrator.h"

#include <algorithm>

namespace hvp::fem {

Integrator::Integrator(const Body& body, const std::vector<double>& load,
                       const std::optional<Dynamics>& dynamics, double period_s, Effort effort)
    : body_load_(load),
      effort_(effort),
      forces_(body.active_nodes()),
      initial_(body.initial_displacement()),
      f_(load),
      loaded_(load.size()) {
  if (!dynamics) return;
  newmark_.emplace(body.stiffness(), body.mass(dynamics->mass), *dynamics, period_s);
  const std::vector<double> rest(f_.size(), 0.0);
  newmark_->set_state(initial_, rest, rest);
  if (newmark_->between_ends()) acted_ = rest;
  predict();
}

void Integrator::predict() {
  newmark_->predict();
  if (forces_at_start_.empty()) {
    newmark_->rhs(body_load_, f_);
  } else {
    newmark_->rhs(body_load_, forces_at_start_, f_);
  }
  for (std::size_t i = 0; i < acted_.size(); ++i) f_[i] += newmark_->start_share() * acted_[i];
}

void Integrator::hold(const Hold& hold) {
  held_.keep(hold);
  predicted_anew_ = false;
  hold_operations_ = fading_operations();
  if (newmark_) {
    hold_operations_ += newmark_->hold_flops(hold);
    // The frame before had no solution: its nodes may be held no longer.
    if (predictors_hold_) {
      hold_operations_ += newmark_->predict_flops() + newmark_->rhs_flops();
      if (effort_ == Effort::computed) predict();
      predicted_anew_ = true;
    }
    predictors_hold_ = hold.present() && hold.elapsed_s > 0;
  }
  if (effort_ == Effort::counted) return;
  if (newmark_) newmark_->hold(hold, f_);
  if (hold.let_go.empty() && hold.loads.empty()) return;
  std::ranges::copy(f_, loaded_.begin());
  forces_.add_to(hold.let_go, loaded_);
  add_loads(hold.loads, loaded_);
}

void Integrator::find_contact_forces(const ContactConstraint& system, std::span<const double> u) {
  const Hold hold = held();
  if (!hold.present()) return;
  if (!newmark_ || !newmark_->between_ends()) {
    system.reaction(u, external_force(), hold.nodes, forces_);
    return;
  }
  for (const int node : hold.nodes) {
    forces_.set(node, newmark_->end_force(u, body_load_, node));
  }
}

double Integrator::contact_force_operations(const ContactConstraint& system) const {
  const std::span<const int> nodes = held().nodes;
  if (nodes.empty()) return 0;
  return newmark_ && newmark_->between_ends() ? newmark_->end_force_flops(nodes)
                                              : system.reaction_flops(nodes);
}

void Integrator::advance(std::span<const double> u) {
  predictors_hold_ = false;
  if (!newmark_ || effort_ == Effort::counted) return;
  if (newmark_->between_ends()) {
    std::ranges::fill(acted_, 0.0);
    forces_.add_to(held().nodes, acted_);
    forces_.add_to(held().let_go, acted_);
    add_loads(held().loads, acted_);
  }
  newmark_->update(u);
  predict();
}

void Integrator::advance(std::span<const double> u, std::span<const double> q) {
  std::ranges::copy(q, forces_at_start_.begin());
  advance(u);
}

void Integrator::start(std::span<const double> q) {
  forces_at_start_.assign(q.begin(), q.end());
  predict();
}

double Integrator::advance_operations() const {
  if (!newmark_) return 0;
  const double rhs =
      forces_at_start_.empty() ? newmark_->rhs_flops() : newmark_->rhs_flops_of_forces();
  return newmark_->update_flops() + newmark_->predict_flops() + rhs +
         2 * static_cast<double>(acted_.size());
}

}  // namespace hvp::fem
