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
  predict();
}

void Integrator::predict() {
  newmark_->predict();
  newmark_->rhs(body_load_, f_);
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
  if (hold.let_go.empty()) return;
  std::ranges::copy(f_, loaded_.begin());
  forces_.add_to(hold.let_go, loaded_);
}

void Integrator::advance(std::span<const double> u) {
  predictors_hold_ = false;
  if (!newmark_ || effort_ == Effort::counted) return;
  newmark_->update(u);
  predict();
}

double Integrator::advance_operations() const {
  if (!newmark_) return 0;
  return newmark_->update_flops() + newmark_->predict_flops() + newmark_->rhs_flops();
}

}  // namespace hvp::fem
