#include "models/fem/linear_tissue.h"

#include <algorithm>

namespace hvp::fem {

namespace {

std::optional<Newmark> make_newmark(const Body& body, const std::optional<Dynamics>& dynamics,
                                    double period_s) {
  if (!dynamics) return std::nullopt;
  return Newmark(body.stiffness(), body.mass(dynamics->mass), *dynamics, period_s);
}

}  // namespace

LinearTissue::LinearTissue(const Body& body, ContactDiagonal diagonal,
                           const std::optional<Dynamics>& dynamics, double period_s, Effort effort)
    : body_(body),
      effort_(effort),
      newmark_(make_newmark(body, dynamics, period_s)),
      matrix_(newmark_ ? newmark_->effective_matrix() : body.stiffness()),
      constraint_(matrix_, diagonal),
      forces_(matrix_.block_rows()),
      initial_(body.initial_displacement()),
      f_(body.load()),
      loaded_(f_.size()) {
  if (!newmark_) return;
  const std::vector<double> rest(f_.size(), 0.0);
  newmark_->set_state(initial_, rest, rest);
  predict();
}

void LinearTissue::predict() {
  newmark_->predict();
  newmark_->rhs(body_.load(), f_);
}

std::span<const double> LinearTissue::velocity() const {
  return newmark_ ? newmark_->velocity() : std::span<const double>();
}

void LinearTissue::hold(const Hold& hold) {
  contact_.assign(hold.nodes.begin(), hold.nodes.end());
  let_go_.assign(hold.let_go.begin(), hold.let_go.end());
  hold_operations_ = 6.0 * static_cast<double>(let_go_.size());
  if (newmark_) {
    hold_operations_ += newmark_->hold_flops(hold);
    // The frame before had no solution: its nodes may be held no longer.
    if (predictors_hold_) {
      hold_operations_ += newmark_->predict_flops() + newmark_->rhs_flops();
      if (effort_ == Effort::computed) predict();
    }
    predictors_hold_ = hold.present() && hold.elapsed_s > 0;
  }
  if (effort_ == Effort::counted) return;
  if (newmark_) newmark_->hold(hold, f_);
  if (let_go_.empty()) return;
  std::ranges::copy(f_, loaded_.begin());
  forces_.add_to(let_go_, loaded_);
}

Eigen::Vector3d LinearTissue::force(std::span<const double> u) {
  if (effort_ == Effort::counted) return Eigen::Vector3d::Zero();
  Eigen::Vector3d fading = forces_.sum(let_go_);
  if (contact_.empty()) return fading;
  return constraint_.reaction(u, f_, contact_, forces_) + fading;
}

void LinearTissue::advance(std::span<const double> u) {
  predictors_hold_ = false;
  if (!newmark_ || effort_ == Effort::counted) return;
  newmark_->update(u);
  predict();
}

double LinearTissue::force_operations() const {
  const double fading = 6.0 * static_cast<double>(let_go_.size());
  return contact_.empty() ? fading : fading + constraint_.reaction_flops(contact_);
}

double LinearTissue::advance_operations() const {
  if (!newmark_) return 0;
  return newmark_->update_flops() + newmark_->predict_flops() + newmark_->rhs_flops();
}

}  // namespace hvp::fem
