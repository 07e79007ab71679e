#pragma once

#include <Eigen/Core>
#include <span>

#include "models/sparse/block_matrix.h"

namespace hvp::fem {

// What an evaluation found on its way through the elements. A linear body finds nothing.
struct ElementsFound {
  int inverted = 0;   // turned inside out: det F is not above zero
  int undefined = 0;  // without forces: the sums are then of no use
  int overflown = 0;  // of those, the ones whose energy is beyond their law's bound

  bool defined() const { return undefined == 0; }
};

// The forces q(u) with which a frame's equation is r(u) = f − q(u) = 0: A·u for a linear body; for
// another one the forces of its elements, and what inertia and damping make of u in this time step.
// Vectors are over active nodes, in m and N. Whoever solves keeps u and q; no call allocates.
class InternalForces {
 public:
  virtual ~InternalForces() = default;

  // True where q(u) = A·u for ever, with the A of Tissue::system().
  virtual bool linear() const = 0;
  // What rounding alone may make of a component of q at rest, N: a residual below it is none. Zero
  // where q is A·u.
  virtual double rounding_n() const { return 0; }
  virtual ElementsFound evaluate(std::span<const double> u, std::span<double> q) = 0;
  // Brings q, as evaluate() gave it for the solution of the frame before, to this frame and to `u`,
  // in which each of `nodes` has moved by `moved` since.
  virtual ElementsFound follow(std::span<const int> nodes, std::span<const Eigen::Vector3d> moved,
                               std::span<const double> u, std::span<double> q) = 0;

  // The additions, multiplications, divisions and roots of the last call of each function; before
  // it, of a call at rest.
  virtual double evaluate_operations() const = 0;
  virtual double follow_operations() const = 0;
};

// A·u.
class LinearForces final : public InternalForces {
 public:
  // Keeps a reference.
  explicit LinearForces(const sparse::BlockMatrix& a) : a_(a) {}
  LinearForces(sparse::BlockMatrix&&) = delete;

  bool linear() const override { return true; }
  ElementsFound evaluate(std::span<const double> u, std::span<double> q) override;
  ElementsFound follow(std::span<const int> nodes, std::span<const Eigen::Vector3d> moved,
                       std::span<const double> u, std::span<double> q) override;

  double evaluate_operations() const override { return 18.0 * static_cast<double>(a_.blocks()); }
  double follow_operations() const override { return follow_operations_; }

 private:
  const sparse::BlockMatrix& a_;
  double follow_operations_ = 0;
};

}  // namespace hvp::fem
