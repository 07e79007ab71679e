#include "models/host/frame_computation.h"

#include <algorithm>
#include <cmath>

#include "models/host/costs.h"

namespace hvp::host {

namespace {

std::optional<fem::Newmark> make_newmark(const fem::Body& body,
                                         const std::optional<fem::Dynamics>& dynamics,
                                         double period_s) {
  if (!dynamics) return std::nullopt;
  return fem::Newmark(body.stiffness(), body.mass(dynamics->mass), *dynamics, period_s);
}

// Rounds the diagonal to a word; one that rounds to nothing would leave the node free.
std::int32_t word_of(double diagonal, const fixed::QuantisedMatrix& matrix) {
  const double limit = std::ldexp(1.0, matrix.bits - 1) - 1;
  return static_cast<std::int32_t>(std::clamp(std::round(diagonal / matrix.scale), 1.0, limit));
}

}  // namespace

FrameComputation::FrameComputation(const fem::Body& body, fem::ContactDiagonal diagonal,
                                   const std::optional<fem::Dynamics>& dynamics,
                                   const fixed::Settings& settings, double period_s)
    : body_(body),
      newmark_(make_newmark(body, dynamics, period_s)),
      matrix_(newmark_ ? newmark_->effective_matrix() : body.stiffness()),
      constraint_(matrix_, diagonal),
      quantised_(fixed::quantise(matrix_, settings.matrix_bits)),
      scaling_(settings, quantised_),
      diagonal_word_(word_of(constraint_.diagonal(), quantised_)),
      f_(body.load()),
      b_(f_.size()),
      u_(body.initial_displacement()) {
  if (newmark_) {
    const std::vector<double> rest(u_.size(), 0.0);
    newmark_->set_state(u_, rest, rest);
    predict();
  }
}

void FrameComputation::predict() {
  newmark_->predict();
  newmark_->rhs(body_.load(), f_);
}

void FrameComputation::set_contact(std::span<const int> patch) {
  contact_.assign(patch.begin(), patch.end());
}

int FrameComputation::form_rhs(const Eigen::Vector3d& u_c, std::span<std::int32_t> words) {
  if (contact_.empty()) {
    std::copy(f_.begin(), f_.end(), b_.begin());
  } else {
    constraint_.modified_rhs(f_, contact_, u_c, b_);
    // The board has the diagonal as a word; the right-hand side has to belong to that word for
    // the solution to be u_c.
    const double diagonal = diagonal_word_ * quantised_.scale;
    for (const int node : contact_) {
      for (int i = 0; i < 3; ++i) b_[static_cast<std::size_t>(3 * node + i)] = diagonal * u_c[i];
    }
  }
  return scaling_.right_hand_side(b_, words);
}

void FrameComputation::accept(std::span<const std::int32_t> words) {
  scaling_.displacements(words, u_);
}

Eigen::Vector3d FrameComputation::force() const {
  if (contact_.empty()) return Eigen::Vector3d::Zero();
  return constraint_.reaction(u_, f_, contact_);
}

void FrameComputation::update() {
  if (!newmark_) return;
  newmark_->update(u_);
  predict();
}

double FrameComputation::form_rhs_operations() const {
  const double conversion = conversion_operations(matrix_.rows());
  return contact_.empty() ? conversion : conversion + constraint_.modified_rhs_flops(contact_);
}

double FrameComputation::force_operations() const {
  const double conversion = conversion_operations(matrix_.rows());
  return contact_.empty() ? conversion : conversion + constraint_.reaction_flops(contact_);
}

double FrameComputation::update_operations() const {
  if (!newmark_) return 0;
  return newmark_->update_flops() + newmark_->predict_flops() + newmark_->rhs_flops();
}

}  // namespace hvp::host
