#include "models/host/host_increments.h"

#include <algorithm>
#include <string>
#include <utility>

#include "models/config/input_error.h"
#include "models/fem/contact.h"
#include "models/stability/force_quality.h"

namespace hvp::host {

HostIncrements::HostIncrements(SolvedBy solver, MakeSolve make, const Refinement& refinement,
                               fem::InternalForces& forces, const sparse::BlockMatrix& matrix,
                               std::span<const double> initial, const fixed::Settings& settings)
    : solver_(solver),
      make_(std::move(make)),
      solve_(make_()),
      refinement_(refinement),
      increments_(forces, matrix, initial, settings.start, settings.displacement_range,
                  settings.displacement_range * fem::mean_diagonal(matrix)),
      rows_(matrix.rows()),
      increment_(initial.size(), 0.0) {}

void HostIncrements::set_contact(std::span<const int> nodes) {
  contact_.assign(nodes.begin(), nodes.end());
  still_.assign(nodes.size(), Eigen::Vector3d::Zero());
  solve_->move_contact(nodes);
}

void HostIncrements::begin(std::span<const double> f, const fem::Hold& hold) {
  flags_ = {};
  went_on_ = false;
  passes_made_ = 0;
  increments_.begin(f, hold);
  begin_operations_ = increments_.begin_operations();
}

void HostIncrements::expect_to_go_on() {
  goes_on_ = true;
  increments_.set_imperceptible(stability::ForceQuality::kNoForce);
}

void HostIncrements::go_on(std::span<const double> f, double /*way*/) {
  went_on_ = true;
  increments_.go_on(f);
}

bool HostIncrements::next(std::span<std::int32_t> /*b*/) {
  next_operations_ = std::exchange(begin_operations_, 0);
  solve_work_ = {};
  const host::Refinement::Passes passes = refinement_.divided(goes_on_);
  for (int pass = 0; pass < (went_on_ ? passes.most_after : passes.before); ++pass) {
    const bool evaluated = !increments_.current();
    const bool formed = increments_.form_residual();
    next_operations_ += rows_ + (evaluated ? increments_.evaluate_operations() : 0);
    if (!formed) break;
    if (went_on_ && pass >= passes.after) {
      next_operations_ += increments_.within_operations();
      if (increments_.within(refinement_.tolerance)) break;
    }
    std::ranges::fill(increment_, 0.0);
    solve_->solve(increments_.residual(), still_, increment_);
    ++passes_made_;
    // The next pass needs every node.
    solve_work_ += solve_->work() + solve_->rest_work();
    ++solve_work_.calls;
    const std::span<double> u = increments_.change();
    for (std::size_t i = 0; i < u.size(); ++i) u[i] += increment_[i];
    next_operations_ += rows_;
  }
  return false;
}

void HostIncrements::finish() {
  const bool converged = increments_.finish(refinement_.tolerance);
  if (!converged) flags_.raise(stability::Flag::not_converged);
  flags_.merge(increments_.flags());
}

bool HostIncrements::renew() {
  // Factors that end at a pivot that is not positive have taken as long, and inverses are charged
  // as if their columns had been made.
  renew_work_ = solve_->set_up_work();
  std::unique_ptr<HostSolve> solve;
  try {
    solve = make_();
  } catch (const InputError&) {
    return false;
  }
  solve_ = std::move(solve);
  solve_->move_contact(contact_);
  renew_work_ = solve_->set_up_work() + solve_->contact_work();
  return true;
}

std::vector<Step> HostIncrements::steps() const {
  const int passes = refinement_.divided(goes_on_).before;
  return {{"first residual (without contact)", Step::Where::host, rows_},
          {"each further pass' residual", Step::Where::host,
           2 * rows_ + increments_.evaluate_operations(), passes - 1},
          {std::string("solve on the host (") + name(solver_) + ")", Step::Where::solver, 0, passes,
           false, solve_->most_work() + solve_->rest_work(), solve_->memory()},
          {"last increment", Step::Where::host, rows_},
          {"residual after the force", Step::Where::host, finish_operations(), 1, true}};
}

}  // namespace hvp::host
