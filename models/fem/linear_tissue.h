#pragma once

#include <optional>
#include <vector>

#include "models/fem/body.h"
#include "models/fem/dynamics.h"
#include "models/fem/newmark.h"
#include "models/fem/tissue.h"

namespace hvp::fem {

// Whether a frame's steps are computed, or only their operations counted.
enum class Effort { computed, counted };

// A body of linear elasticity, thesis §3.5 and §3.6: A is K, or Newmark's Â with inertia. It never
// changes. Counted only, the body stays where it was at the beginning and the force is zero.
class LinearTissue final : public Tissue {
 public:
  // Keeps a reference to the body. `period_s` is the servo period, Newmark's time step. Throws
  // InputError for an unstable time integration.
  LinearTissue(const Body& body, ContactDiagonal diagonal, const std::optional<Dynamics>& dynamics,
               double period_s, Effort effort);
  LinearTissue(const LinearTissue&) = delete;
  LinearTissue& operator=(const LinearTissue&) = delete;

  const sparse::BlockMatrix& system() const override { return matrix_; }
  std::int64_t revision() const override { return 0; }
  const ContactConstraint& constraint() const override { return constraint_; }

  void hold(const Hold& hold) override;
  std::span<const double> load() const override {
    return held_.hold().let_go.empty() ? f_ : loaded_;
  }
  std::span<const double> external_force() const override { return f_; }
  void forces(std::span<const double> u, std::span<Eigen::Vector3d> of_probes) override;
  void advance(std::span<const double> u) override;

  std::span<const double> initial_displacement() const override { return initial_; }
  std::span<const double> velocity() const override;

  double hold_operations() const override { return hold_operations_; }
  double force_operations() const override;
  double advance_operations() const override;

 private:
  void predict();

  const Body& body_;
  Effort effort_;
  std::optional<Newmark> newmark_;
  sparse::BlockMatrix matrix_;
  ContactConstraint constraint_;
  KeptHold held_;
  HeldForces forces_;
  bool predictors_hold_ = false;  // they were changed by hold() and not used up by advance()
  double hold_operations_ = 0;
  std::vector<double> initial_;
  std::vector<double> f_;
  std::vector<double> loaded_;
};

}  // namespace hvp::fem
