#include "models/host/frame_computation.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "models/config/input_error.h"
#include "models/host/board_words.h"
#include "models/host/costs.h"
#include "models/host/dense_solve.h"
#include "models/host/explicit_method.h"
#include "models/host/host_increments.h"

namespace hvp::host {

namespace {

std::unique_ptr<HostSolve> make_host_solve(const SolverChoice& solver, const sparse::BlockMatrix& a,
                                           const fixed::Settings& settings) {
  switch (solver.by) {
    case SolvedBy::cg: {
      const bool warm = settings.start != fixed::Start::zero;
      if (solver.precision == Precision::single_precision) {
        return std::make_unique<ConjugateGradients<float>>(a, settings.iterations,
                                                           settings.stop_residual, warm);
      }
      return std::make_unique<ConjugateGradients<double>>(a, settings.iterations,
                                                          settings.stop_residual, warm);
    }
    case SolvedBy::cholesky:
      return std::make_unique<Prefactored>(a);
    case SolvedBy::inverse:
    case SolvedBy::superposition:
    case SolvedBy::condensed:
      return make_dense_solve(solver, a);
    case SolvedBy::board:
    case SolvedBy::steps:
      break;
  }
  return nullptr;
}

double largest_entry(const sparse::BlockMatrix& a) {
  double largest = 0;
  for (const double entry : a.value) largest = std::max(largest, std::abs(entry));
  return largest;
}

const char* name_of_update(std::optional<fem::Scheme> scheme) {
  if (!scheme) return "update after the force";
  return *scheme == fem::Scheme::newmark ? "Newmark's update after the force"
                                         : "generalised-α's update after the force";
}

[[noreturn]] void refuse_counting() {
  throw InputError(
      "the operations of refinement and of a solve on the host depend on the numbers: "
      "expected neither where nothing is computed");
}

}  // namespace

FrameComputation::FrameComputation(const fem::Body& body, fem::ContactDiagonal diagonal,
                                   const std::optional<fem::Dynamics>& dynamics,
                                   const fixed::Settings& settings, double period_s,
                                   const std::optional<Refinement>& refinement,
                                   const SolverChoice& solver, Effort effort)
    : FrameComputation(
          std::make_unique<fem::LinearTissue>(body, diagonal, dynamics, period_s, effort), settings,
          refinement, solver, effort) {}

FrameComputation::FrameComputation(std::unique_ptr<fem::Tissue> tissue,
                                   const fixed::Settings& settings,
                                   const std::optional<Refinement>& refinement,
                                   const SolverChoice& solver, Effort effort,
                                   const fem::MatrixRenewal& renewal)
    : tissue_(std::move(tissue)), effort_(effort), renewal_(renewal) {
  if (renewal_.present()) {
    if (solver.by == SolvedBy::steps || tissue_->renewable() == nullptr) {
      throw InputError("only the matrix of a body that is not linear, and is solved, is renewed");
    }
    formed_ = matrix();
    largest_at_rest_ = largest_entry(matrix());
  }
  const std::span<const double> initial = tissue_->initial_displacement();
  fem::InternalForces& forces = tissue_->internal_forces();
  if (fem::ExplicitSteps* steps = tissue_->explicit_steps()) {
    method_ = std::make_unique<ExplicitMethod>(*steps);
    if (timing_only()) refuse_counting();
    return;
  }
  if (!forces.linear() && !refinement) {
    throw InputError("the body is not linear: expected refinement, which solves by increments");
  }
  if (solver.by != SolvedBy::board) {
    const auto make = [this, solver, settings] {
      return make_host_solve(solver, matrix(), settings);
    };
    if (forces.linear()) {
      std::unique_ptr<HostSolve> solve = make();
      method_ = std::make_unique<HostMethod>(solver.by, std::move(solve), initial);
    } else {
      auto increments = std::make_unique<HostIncrements>(solver.by, make, *refinement, forces,
                                                         matrix(), initial, settings);
      increments_ = &increments->increments();
      method_ = std::move(increments);
    }
  } else {
    board_.emplace(matrix(), settings, tissue_->constraint().diagonal(), refinement.has_value(),
                   renewal_.present() ? renewal_.headroom : 1.0);
    if (refinement) {
      auto refined =
          std::make_unique<RefinedSolve>(*refinement, forces, matrix(), board_->words(), initial);
      refined_ = refined.get();
      increments_ = &refined->increments();
      method_ = std::move(refined);
    } else {
      method_ = std::make_unique<BoardWords>(tissue_->constraint(), *board_, initial, effort);
    }
  }
  if (timing_only() && (refined_ != nullptr || !has_board())) refuse_counting();
}

void FrameComputation::set_contact(std::span<const int> patch) {
  const std::vector<Eigen::Vector3d> nowhere(patch.size(), Eigen::Vector3d::Zero());
  held_.keep({patch, nowhere, {}, 0});
  method_->set_contact(patch);
}

void FrameComputation::hold(const fem::Hold& hold) {
  assert(std::ranges::equal(hold.nodes, contact()));
  held_.keep(hold);
  tissue_->hold(hold);
}

bool FrameComputation::renewal_is_due() {
  if (!renewal_.present() || method_->passes_made() == 0) return false;
  if (++frames_since_renewal_ < renewal_.every || increments_->diverged()) return false;
  frames_since_renewal_ = 0;
  return true;
}

stability::Flags FrameComputation::renew() {
  fem::RenewableSystem& system = *tissue_->renewable();
  const fem::FormedSystem formed = system.form(displacement(), formed_);
  renew_operations_ = formed.operations;
  if (!formed.defined) {
    ++renewals_.undefined;
    return {};
  }
  renewals_.projected = std::max<std::int64_t>(renewals_.projected, formed.projected);
  if (has_board()) return renew_words();
  renew_factors();
  return {};
}

stability::Flags FrameComputation::renew_words() {
  renew_operations_ += words_operations();
  const fixed::Fit fit = board_->renew(formed_);
  renewals_.growth = std::max(renewals_.growth, fit.filling * renewal_.headroom);
  if (fit.beyond > 0) {
    ++renewals_.beyond;
    renewals_.words_beyond += fit.beyond;
    stability::Flags flags;
    flags.raise(stability::Flag::matrix_word_beyond_scale);
    return flags;
  }
  tissue_->renewable()->take(formed_);
  ++renewals_.renewed;
  return {};
}

void FrameComputation::renew_factors() {
  renewals_.growth = std::max(renewals_.growth, largest_entry(formed_) / largest_at_rest_);
  last_ = matrix();
  tissue_->renewable()->take(formed_);
  if (method_->renew()) {
    ++renewals_.renewed;
  } else {
    tissue_->renewable()->take(last_);
    ++renewals_.undefined;
  }
}

// Of the formed matrix into words.
double FrameComputation::words_operations() const {
  const int entries = static_cast<int>(formed_.value.size());
  const bool scaled = board_->settings().matrix_scaling != fixed::MatrixScaling::none;
  return conversion_operations(entries) + (scaled ? 2.0 * entries : 0);
}

double FrameComputation::typical_renew_operations() const {
  if (!renewal_.present()) return 0;
  return tissue_->renewable()->typical_operations() + (has_board() ? words_operations() : 0);
}

std::vector<Step> FrameComputation::steps() const {
  std::vector<Step> steps = method_->steps();
  const auto after = std::ranges::find(steps, true, &Step::after_force);
  steps.insert(after, {"force (without contact)", Step::Where::host, method_->force_operations()});
  // Explicit steps have made theirs before the force.
  if (explicit_steps() == nullptr) {
    steps.push_back(
        {name_of_update(tissue_->scheme()), Step::Where::host, update_operations(), 1, true});
  }
  return steps;
}

std::vector<Step> FrameComputation::steps_with_loads(double contact_operations,
                                                     bool first_solve) const {
  std::vector<Step> steps;
  const std::vector<Step> of_method = method_->steps();
  for (const Step& step : of_method) {
    if (first_solve && !step.after_force && step.times > 0) steps.push_back(step);
  }
  if (first_solve) {
    steps.push_back({"U out of its words", Step::Where::host, method_->force_operations()});
  }
  steps.push_back({"the proxies' forces", Step::Where::host, contact_operations});
  for (const Step& step : first_solve ? method_->further_steps() : of_method) {
    steps.push_back(step);
    steps.back().after_force = true;
  }
  steps.push_back({"U out of its words", Step::Where::host, method_->force_operations(), 1, true});
  steps.push_back(
      {name_of_update(tissue_->scheme()), Step::Where::host, update_operations(), 1, true});
  return steps;
}

}  // namespace hvp::host
