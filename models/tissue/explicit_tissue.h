#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "models/fem/body.h"
#include "models/fem/contact.h"
#include "models/fem/explicit_steps.h"
#include "models/fem/hold.h"
#include "models/fem/newmark.h"
#include "models/fem/reference_model.h"
#include "models/fem/tissue.h"
#include "models/tissue/central_differences.h"
#include "models/tissue/step_watch.h"

namespace hvp::tissue {

// A body in the servo loop that moves by central differences, in equal substeps of the servo
// period: no system is solved, by nobody. system() is K at rest, for those who ask how stiff the
// body is.
class ExplicitTissue final : public fem::Tissue,
                             public fem::InternalForces,
                             public fem::ExplicitSteps {
 public:
  // The share of the limit at rest that a substep takes where their number is left open. A deformed
  // body has a shorter one: docs/tissue.md.
  static constexpr double kShare = 0.8;

  // Keeps a reference to the body. `substeps` a frame; 0: as many as kShare asks for. Throws
  // InputError, with a key of the scenario's, for stiffness damping, a mass that is not lumped, or
  // a substep above the limit at rest.
  ExplicitTissue(std::unique_ptr<PotentialBody> body, fem::ContactDiagonal diagonal,
                 const fem::Dynamics& dynamics, double period_s, int substeps);
  ExplicitTissue(const ExplicitTissue&) = delete;
  ExplicitTissue& operator=(const ExplicitTissue&) = delete;

  const sparse::BlockMatrix& system() const override { return body_->body().stiffness(); }
  std::int64_t revision() const override { return 0; }
  const fem::ContactConstraint& constraint() const override { return constraint_; }
  fem::InternalForces& internal_forces() override { return *this; }
  fem::ExplicitSteps* explicit_steps() override { return this; }

  std::optional<fem::Scheme> scheme() const override { return std::nullopt; }

  void hold(const fem::Hold& hold) override;
  std::span<const double> load() const override { return load_; }
  std::span<const double> external_force() const override { return body_->body().dead_load(); }
  void forces(std::span<const double> u, std::span<Eigen::Vector3d> of_probes) override;
  void advance(std::span<const double> /*u*/) override {}
  std::span<const double> initial_displacement() const override { return initial_; }
  std::span<const double> velocity() const override { return velocity_; }
  double hold_operations() const override;
  double force_operations() const override;
  double advance_operations() const override { return 0; }

  // The static forces of the body: nobody solves with them.
  bool linear() const override { return linear_; }
  fem::ElementsFound evaluate(std::span<const double> u, std::span<double> q) override;
  fem::ElementsFound follow(std::span<const int> nodes, std::span<const Eigen::Vector3d> moved,
                            std::span<const double> u, std::span<double> q) override;
  double evaluate_operations() const override { return evaluate_operations_; }
  double follow_operations() const override { return evaluate_operations_; }

  fem::StepsFound step() override;
  std::span<const double> displacement() const override { return steps_.displacement(); }
  int substeps() const override { return substeps_; }
  double substep_s() const override { return steps_.substep_s(); }
  double limit_at_rest_s() const override { return limit_at_rest_; }
  double least_limit_s() const override { return least_limit_; }
  double step_operations() const override { return step_operations_; }

 private:
  std::unique_ptr<PotentialBody> body_;
  bool linear_;
  fem::ContactConstraint constraint_;
  double limit_at_rest_;
  int substeps_;
  CentralDifferences steps_;
  StepWatch watch_;
  double least_limit_ = std::numeric_limits<double>::infinity();
  fem::KeptHold held_;
  fem::HeldForces contact_forces_;
  bool fading_ = false;  // load_ has the forces of released nodes
  std::vector<double> load_, initial_, velocity_, full_, forces_;
  double evaluate_operations_ = 0;
  double step_operations_ = 0;
};

// The same frames with four times the substeps, without the watch of the limit's verdicts: the
// truth that an explicit run is compared with, to the second order in time.
class FineSteps final : public fem::ReferenceModel {
 public:
  static constexpr int kFiner = 4;

  FineSteps(std::unique_ptr<PotentialBody> body, const fem::Dynamics& dynamics, double period_s,
            int substeps, std::size_t probes);

  void solve(const fem::Hold& hold) override;
  // The substeps are the time step.
  void advance() override {}
  std::span<const double> displacement() const override { return tissue_.displacement(); }
  std::span<const double> velocity() const override { return tissue_.velocity(); }
  std::span<const Eigen::Vector3d> forces() const override { return of_probes_; }
  std::int64_t unsolved() const override { return unsolved_; }
  std::int64_t overflown() const override { return overflown_; }

 private:
  ExplicitTissue tissue_;
  std::vector<Eigen::Vector3d> of_probes_;
  std::int64_t unsolved_ = 0;
  std::int64_t overflown_ = 0;
};

}  // namespace hvp::tissue
