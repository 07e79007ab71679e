#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "models/fem/internal_forces.h"
#include "models/host/host_solve.h"
#include "models/host/increments.h"
#include "models/host/refinement.h"

namespace hvp::host {

// The method in which the host solves for the increments of a body that is not linear, with the
// matrix of the body at rest or a renewed one: as many passes as refinement.passes, or fewer where
// the residual is within refinement.tolerance before.
class HostIncrements final : public FrameMethod {
 public:
  // Makes a solver of the matrix as it is. Throws InputError where that has none.
  using MakeSolve = std::function<std::unique_ptr<HostSolve>()>;

  // Keeps references to `forces` and to `matrix`. Throws what `make` throws.
  HostIncrements(SolvedBy solver, MakeSolve make, const Refinement& refinement,
                 fem::InternalForces& forces, const sparse::BlockMatrix& matrix,
                 std::span<const double> initial, const fixed::Settings& settings);

  const Increments& increments() const { return increments_; }

  void set_contact(std::span<const int> nodes) override;
  void begin(std::span<const double> f, const fem::Hold& hold) override;
  void expect_to_go_on() override;
  void go_on(std::span<const double> f, double way) override;
  // Makes all passes.
  bool next(std::span<std::int32_t> b) override;
  void accept(std::span<const std::int32_t> /*x*/, stability::Flags /*flags*/) override {}
  void finish() override;
  void abandon() override { increments_.abandon(); }
  bool renew() override;

  std::span<const double> displacement() const override { return increments_.displacement(); }
  stability::Flags flags() const override { return flags_; }

  // Residuals and increments; HostSolve counts the solves.
  double next_operations() const override { return next_operations_; }
  SolveWork solve_work() const override { return solve_work_; }
  SolveWork contact_work() const override { return solve_->contact_work(); }
  SolveWork set_up_work() const override { return solve_->set_up_work(); }
  SolveWork renew_work() const override { return renew_work_; }
  int passes_made() const override { return passes_made_; }
  SolveMemory memory() const override { return solve_->memory(); }
  double finish_operations() const override { return increments_.finish_operations(); }
  std::vector<Step> steps() const override;

 private:
  SolvedBy solver_;
  MakeSolve make_;
  std::unique_ptr<HostSolve> solve_;
  Refinement refinement_;
  Increments increments_;
  double rows_;
  std::vector<double> increment_;
  std::vector<int> contact_;
  std::vector<Eigen::Vector3d> still_;  // contact nodes' increments: none
  stability::Flags flags_;
  bool goes_on_ = false;
  bool went_on_ = false;
  double begin_operations_ = 0;  // since the last next()
  double next_operations_ = 0;
  SolveWork solve_work_;
  SolveWork renew_work_;
  int passes_made_ = 0;
};

}  // namespace hvp::host
