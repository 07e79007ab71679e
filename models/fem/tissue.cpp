#include "models/fem/tissue.h"

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
  held_.keep(hold);
  hold_operations_ = 6.0 * static_cast<double>(hold.let_go.size());
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
  if (hold.let_go.empty()) return;
  std::ranges::copy(f_, loaded_.begin());
  forces_.add_to(hold.let_go, loaded_);
}

void LinearTissue::forces(std::span<const double> u, std::span<Eigen::Vector3d> of_probes) {
  if (effort_ == Effort::counted) {
    std::ranges::fill(of_probes, Eigen::Vector3d::Zero());
    return;
  }
  if (!held_.nodes().empty()) constraint_.reaction(u, f_, held_.nodes(), forces_);
  forces_.sum(held_.hold(), of_probes);
}

void LinearTissue::advance(std::span<const double> u) {
  predictors_hold_ = false;
  if (!newmark_ || effort_ == Effort::counted) return;
  newmark_->update(u);
  predict();
}

double LinearTissue::force_operations() const {
  const Hold hold = held_.hold();
  const double fading = 6.0 * static_cast<double>(hold.let_go.size());
  return hold.present() ? fading + constraint_.reaction_flops(hold.nodes) : fading;
}

double LinearTissue::advance_operations() const {
  if (!newmark_) return 0;
  return newmark_->update_flops() + newmark_->predict_flops() + newmark_->rhs_flops();
}

}  // namespace hvp::fem
