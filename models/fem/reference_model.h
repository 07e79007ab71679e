#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "models/fem/hold.h"

namespace hvp::fem {

// A run's frames in double precision, with a state of their own: what a perfect solver would make
// of them. Vectors are over active nodes.
class ReferenceModel {
 public:
  virtual ~ReferenceModel() = default;

  // Computes one frame with the run's contact nodes and prescribed displacements. The fading forces
  // at released nodes are the reference's own.
  void step(const Hold& hold) {
    solve(hold);
    advance();
  }
  // The two halves of a step. Loads of contact may be solved for again before the time step is
  // made; prescribed displacements may not.
  virtual void solve(const Hold& hold) = 0;
  virtual void advance() = 0;
  virtual std::span<const double> displacement() const = 0;  // m
  virtual std::span<const double> velocity() const = 0;      // m/s; empty for a static body
  // The forces on the body of each probe in the last solve(), N.
  virtual std::span<const Eigen::Vector3d> forces() const = 0;
  // True if the body's forces are A·u.
  virtual bool linear() const { return false; }
  // The frames so far whose equation was not solved to rounding: no reference to compare with.
  virtual std::int64_t unsolved() const { return 0; }
  // Those of them in which an element's energy was beyond what its law is defined for.
  virtual std::int64_t overflown() const { return 0; }
  // The tangents of solved frames so far that were not positive definite: the body gave way there,
  // and the solution was found by other steps than Newton's. It may be one of several.
  virtual std::int64_t indefinite() const { return 0; }
};

}  // namespace hvp::fem
