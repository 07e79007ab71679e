#include "models/tissue/newton_run.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "models/index.h"

namespace hvp::tissue {

namespace {

// Factors that leave more than this share of the residual are formed anew.
constexpr double kSlow = 0.1;
constexpr int kMostShortenings = 12;
// So many slow steps in a row with the matrix at rest, and Newton's own step is tried where the
// tangent is not positive definite: it lowers the residual there too, but may lead far.
constexpr int kPatience = 4;

}  // namespace

NewtonRun::NewtonRun(const fem::Body& body, const Constitution& constitution,
                     const std::optional<fem::Dynamics>& dynamics, double period_s,
                     std::size_t probes)
    : tissue_(body, constitution, fem::ContactDiagonal::average, dynamics, period_s),
      tangent_(body.stiffness()),
      u_(body.initial_displacement()),
      trial_(u_),
      q_(u_.size()),
      r_(u_.size()),
      direction_(u_.size()),
      rounding_n_(tissue_.rounding_n()),
      of_probes_(probes, Eigen::Vector3d::Zero()) {
  residual_n_.reserve(kMostSteps + 1);
}

void NewtonRun::solve(const fem::Hold& hold) {
  tissue_.hold(hold);
  const std::int64_t indefinite = indefinite_;
  overflows_ = false;
  if (tries() && find_solution(hold)) {
    unsolved_in_a_row_ = 0;
  } else {
    ++unsolved_;
    ++unsolved_in_a_row_;
    if (overflows_) ++overflown_;
    // Where no solution was found the body did not give way on the way to one.
    indefinite_ = indefinite;
  }
  // The forces of the last evaluation may be those of a step that was not taken.
  look_at(u_, hold.nodes);
  tissue_.forces(u_, of_probes_);
}

double NewtonRun::look_at(std::span<const double> u, std::span<const int> contact) {
  const fem::ElementsFound found = tissue_.evaluate(u, q_);
  overflows_ = overflows_ || found.overflown > 0;
  if (!found.defined()) return std::numeric_limits<double>::infinity();
  const std::span<const double> f = tissue_.load();
  for (std::size_t i = 0; i < r_.size(); ++i) {
    r_[i] = f[i] - q_[i];
    largest_force_n_ = std::max({largest_force_n_, std::abs(f[i]), std::abs(q_[i])});
  }
  for (const int node : contact) std::fill_n(&r_[3 * at(node)], 3, 0.0);
  double largest = 0;
  for (const double r : r_) largest = std::max(largest, std::abs(r));
  return largest;
}

// Forms the tangent where the run is and chooses the factors of the next steps. The matrix at rest
// is downhill where the tangent is not positive definite; `anyhow` is Newton's step all the same.
void NewtonRun::factorise(bool anyhow) {
  static_cast<void>(tissue_.tangent(tangent_));
  ++tangents_;
  const bool finite =
      std::ranges::all_of(tangent_.value, [](double entry) { return std::isfinite(entry); });
  if (finite) {
    exact_.emplace(tangent_);
    if (exact_->positive_definite()) {
      factors_ = &*exact_;
      return;
    }
  }
  ++indefinite_;
  if (finite && anyhow && !exact_->singular()) {
    factors_ = &*exact_;
    return;
  }
  if (!at_rest_) at_rest_.emplace(tissue_.system());
  factors_ = &*at_rest_;
}

bool NewtonRun::find_solution(const fem::Hold& hold) {
  residual_n_.clear();
  double residual = look_at(u_, hold.nodes);
  residual_n_.push_back(residual);
  if (!std::isfinite(residual)) return false;
  const std::int64_t last_tangent = tangents_ + kMostTangents;
  if (factors_ == nullptr) factorise(false);
  bool fresh = false;
  int slow_at_rest = 0;
  for (int i = 0; i < kMostSteps && tangents_ < last_tangent; ++i) {
    gap_.clear();
    bool there = true;
    for (std::size_t n = 0; n < hold.nodes.size(); ++n) {
      const double* u = &u_[3 * at(hold.nodes[n])];
      gap_.push_back(hold.displacement[n] - Eigen::Vector3d(u[0], u[1], u[2]));
      there = there && gap_.back().isZero(0);
    }
    if (there && residual <= std::max(kTolerance * largest_force_n_, rounding_n_)) return true;
    if (hold.present()) {
      factors_->solve_with_contact(r_, hold.nodes, gap_, direction_);
    } else {
      factors_->solve(r_, direction_);
    }
    const double before = residual;
    const bool at_rest = at_rest_ && factors_ == &*at_rest_;
    const bool taken = make_step(hold, residual);
    if (!taken && fresh && at_rest) return false;
    if (taken) residual_n_.push_back(residual);
    fresh = false;
    if (!taken || (there && residual > kSlow * before)) {
      slow_at_rest = at_rest ? slow_at_rest + 1 : 0;
      look_at(u_, hold.nodes);
      factorise(taken && slow_at_rest >= kPatience);
      fresh = true;
    }
  }
  return false;
}

// Takes the longest of the steps 1, ½, ¼… that is defined and, where contact is in its place
// already, leaves less. A whole step puts contact nodes where they belong to the last bit.
bool NewtonRun::make_step(const fem::Hold& hold, double& residual) {
  const bool there =
      std::ranges::all_of(gap_, [](const Eigen::Vector3d& g) { return g.isZero(0); });
  double share = 1;
  for (int i = 0; i <= kMostShortenings; ++i, share /= 2) {
    for (std::size_t k = 0; k < u_.size(); ++k) trial_[k] = u_[k] + share * direction_[k];
    if (share == 1) {
      for (std::size_t n = 0; n < hold.nodes.size(); ++n) {
        std::copy_n(hold.displacement[n].data(), 3, &trial_[3 * at(hold.nodes[n])]);
      }
    }
    const double next = look_at(trial_, hold.nodes);
    if (!std::isfinite(next) || (there && !(next < residual))) continue;
    std::swap(u_, trial_);
    residual = next;
    return true;
  }
  return false;
}

}  // namespace hvp::tissue
