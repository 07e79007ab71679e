#include "models/host/frame_computation.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "models/config/input_error.h"
#include "models/host/costs.h"

namespace hvp::host {

namespace {

std::optional<fem::Newmark> make_newmark(const fem::Body& body,
                                         const std::optional<fem::Dynamics>& dynamics,
                                         double period_s) {
  if (!dynamics) return std::nullopt;
  return fem::Newmark(body.stiffness(), body.mass(dynamics->mass), *dynamics, period_s);
}

// Rounds the diagonal to a word; one that rounds to nothing would leave the node free. Where the
// matrix is scaled its diagonal is one throughout, and so is the contact's.
std::int32_t word_of(double diagonal, const fixed::System& system) {
  const fixed::QuantisedMatrix& matrix = system.matrix;
  const bool scaled = system.settings.matrix_scaling == fixed::MatrixScaling::diagonal;
  const double limit = std::ldexp(1.0, matrix.bits - 1) - 1;
  const double entry = scaled ? 1.0 : diagonal;
  return static_cast<std::int32_t>(std::clamp(std::round(entry / matrix.scale), 1.0, limit));
}

fixed::Settings settings_of_board(const fixed::System& system, bool refined) {
  fixed::Settings settings = system.settings;
  if (refined) settings.start = fixed::Start::zero;
  return settings;
}

std::unique_ptr<HostSolve> make_host_solve(Solver solver, const sparse::BlockMatrix& a,
                                           const fixed::Settings& settings) {
  switch (solver) {
    case Solver::cg:
      return std::make_unique<ConjugateGradients>(a, settings.iterations, settings.stop_residual,
                                                  settings.start != fixed::Start::zero);
    case Solver::cholesky:
      return std::make_unique<Prefactored>(a);
    case Solver::board:
      break;
  }
  return nullptr;
}

}  // namespace

FrameComputation::FrameComputation(const fem::Body& body, fem::ContactDiagonal diagonal,
                                   const std::optional<fem::Dynamics>& dynamics,
                                   const fixed::Settings& settings, double period_s,
                                   const std::optional<Refinement>& refinement, Solver solver,
                                   Effort effort)
    : body_(body),
      effort_(effort),
      newmark_(make_newmark(body, dynamics, period_s)),
      matrix_(newmark_ ? newmark_->effective_matrix() : body.stiffness()),
      constraint_(matrix_, diagonal),
      system_(fixed::prepare(matrix_, settings)),
      board_settings_(settings_of_board(system_, refinement.has_value())),
      scaling_(system_),
      diagonal_word_(word_of(constraint_.diagonal(), system_)),
      forces_(matrix_.block_rows()),
      f_(body.load()),
      loaded_(f_.size()),
      b_(f_.size()),
      u_(body.initial_displacement()),
      on_host_(make_host_solve(solver, matrix_, settings)) {
  if (newmark_) {
    const std::vector<double> rest(u_.size(), 0.0);
    newmark_->set_state(u_, rest, rest);
    predict();
  }
  if (refinement) refined_.emplace(*refinement, matrix_, system_, u_);
  if (timing_only() && (refined_ || on_host_)) {
    throw InputError(
        "the operations of refinement and of a solve on the host depend on the numbers: "
        "expected neither where nothing is computed");
  }
}

void FrameComputation::predict() {
  newmark_->predict();
  newmark_->rhs(body_.load(), f_);
}

void FrameComputation::set_contact(std::span<const int> patch) {
  contact_.assign(patch.begin(), patch.end());
  held_displacement_.assign(patch.size(), Eigen::Vector3d::Zero());
  let_go_.clear();
  elapsed_s_ = 0;
}

void FrameComputation::hold(const fem::Hold& hold) {
  assert(std::ranges::equal(hold.nodes, contact_));
  std::ranges::copy(hold.displacement, held_displacement_.begin());
  let_go_.assign(hold.let_go.begin(), hold.let_go.end());
  elapsed_s_ = hold.elapsed_s;
  hold_operations_ = 6.0 * static_cast<double>(let_go_.size());
  if (newmark_) {
    hold_operations_ += newmark_->hold_flops(hold);
    // The frame before had no solution: its nodes may be held no longer.
    if (predictors_hold_) {
      hold_operations_ += newmark_->predict_flops() + newmark_->rhs_flops();
      if (!timing_only()) predict();
    }
    predictors_hold_ = hold.present() && hold.elapsed_s > 0;
  }
  if (timing_only()) return;
  if (newmark_) newmark_->hold(hold, f_);
  if (let_go_.empty()) return;
  std::ranges::copy(f_, loaded_.begin());
  forces_.add_to(let_go_, loaded_);
}

int FrameComputation::form_rhs(std::span<std::int32_t> words) {
  if (timing_only()) return 0;
  if (contact_.empty()) {
    std::ranges::copy(load(), b_.begin());
  } else {
    constraint_.modified_rhs(load(), contact_, held_displacement_, b_);
    // The board has the diagonal as a word; the right-hand side has to belong to that word for
    // the solution to be u: word · scale · u = s·b with u/s for u in a scaled system.
    const double diagonal = diagonal_word_ * system_.matrix.scale;
    for (std::size_t n = 0; n < contact_.size(); ++n) {
      for (int i = 0; i < 3; ++i) {
        const auto row = static_cast<std::size_t>(3 * contact_[n] + i);
        b_[row] = diagonal / (system_.scale[row] * system_.scale[row]) * held_displacement_[n][i];
      }
    }
  }
  return scaling_.right_hand_side(b_, words);
}

void FrameComputation::accept(std::span<const std::int32_t> words) {
  if (timing_only()) return;
  scaling_.displacements(words, u_);
  if (elapsed_s_ == 0) return;
  for (std::size_t n = 0; n < contact_.size(); ++n) {
    for (int i = 0; i < 3; ++i) {
      u_[static_cast<std::size_t>(3 * contact_[n] + i)] = held_displacement_[n][i];
    }
  }
}

Eigen::Vector3d FrameComputation::force() {
  if (timing_only()) return Eigen::Vector3d::Zero();
  Eigen::Vector3d fading = forces_.sum(let_go_);
  if (contact_.empty()) return fading;
  return constraint_.reaction(displacement(), f_, contact_, forces_) + fading;
}

void FrameComputation::update() {
  predictors_hold_ = false;
  if (!newmark_ || timing_only()) return;
  newmark_->update(displacement());
  predict();
}

// A word more to scale where every equation has a scale of its own.
double FrameComputation::conversion() const {
  const bool scaled = system_.settings.matrix_scaling != fixed::MatrixScaling::none;
  return conversion_operations(matrix_.rows()) + (scaled ? matrix_.rows() : 0);
}

double FrameComputation::form_rhs_operations() const {
  return contact_.empty() ? conversion() : conversion() + constraint_.modified_rhs_flops(contact_);
}

double FrameComputation::force_operations() const {
  const double words = refined_ || on_host_ ? 0 : conversion();
  const double fading = words + 6.0 * static_cast<double>(let_go_.size());
  return contact_.empty() ? fading : fading + constraint_.reaction_flops(contact_);
}

double FrameComputation::update_operations() const {
  if (!newmark_) return 0;
  return newmark_->update_flops() + newmark_->predict_flops() + newmark_->rhs_flops();
}

}  // namespace hvp::host
