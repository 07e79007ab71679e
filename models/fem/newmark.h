#pragma once

#include <span>
#include <vector>

#include "models/fem/dynamics.h"
#include "models/fem/hold.h"
#include "models/sparse/block_matrix.h"

namespace hvp::fem {

// Newmark's time integration of M·Ü + C·U̇ + K·U = f, thesis §3.6.1, with C = α·M + β·K. One step:
//
//   predict();                      // ã, ṽ from the present state, (3.26)
//   rhs(f, f_hat);                  // f̂ = f − C·ṽ − M·ã
//   hold(hold, f_hat);              // where nodes are held
//   … solve Â·u = f̂ …               // (3.27), by whoever solves
//   update(u);                      // (3.25)
//
// f is the external force at the step's end with the sign of (3.20), not of (3.23). The thesis
// lost the tildes of ã and ṽ in (3.25), (3.26) and (3.28). No step allocates.
class Newmark {
 public:
  // K (N/m) and M (kg) over the same nodes; M's pattern lies within K's. The state starts at
  // rest with zero displacement. Throws InputError for an unstable rule or a Δt that is not
  // positive and finite.
  Newmark(const sparse::BlockMatrix& stiffness, const sparse::BlockMatrix& mass,
          const Dynamics& dynamics, double time_step_s);

  // Â = 2/(βΔt²)·M + 2γ/(βΔt)·C + K, thesis (3.28), in K's pattern.
  const sparse::BlockMatrix& effective_matrix() const { return effective_; }

  void predict();
  // f and f_hat do not overlap.
  void rhs(std::span<const double> f, std::span<double> f_hat) const;
  // A node that is held has no equation of motion: its displacement u' is given, and Newmark's
  // recursion of its velocity and acceleration neither converges nor, for γ = ½, decays, so that
  // each jump of its way rings in the force. Its velocity becomes that of its way, (u' −
  // u)/elapsed, and its acceleration zero:
  //   q = (u' − u)/elapsed − (ṽ + 2γ/(βΔt)·u'),   p = −(ã + 2/(βΔt²)·u'),
  //   ṽ += q,   ã += p,   f̂ −= C·q + M·p,
  // so that (3.25) and (3.27) stay what they are, and the force A·u' − f̂ at the node is without
  // inertia of its own. Changes nothing where hold.elapsed_s is zero. Calling it again before
  // update() is safe: q and p are relative to what is there.
  void hold(const Hold& hold, std::span<double> f_hat);
  void update(std::span<const double> u_next);

  std::span<const double> displacement() const { return u_; }  // m
  std::span<const double> velocity() const { return v_; }      // m/s
  std::span<const double> acceleration() const { return a_; }  // m/s²
  void set_state(std::span<const double> u, std::span<const double> v, std::span<const double> a);

  // ½·U̇ᵀM·U̇ + ½·UᵀK·U in joules.
  double energy() const;

  double time_step_s() const { return time_step_; }

  // Additions and multiplications of one call. The sparse products dominate: 18 a block of K
  // (none without stiffness damping) and, with the consistent mass, 18 a block of M.
  double predict_flops() const;
  double rhs_flops() const;
  double update_flops() const;
  double hold_flops(const Hold& hold) const;

 private:
  void subtract_column(const sparse::BlockMatrix& matrix, int node, const Eigen::Vector3d& x,
                       std::span<double> f_hat) const;

  sparse::BlockMatrix stiffness_;
  sparse::BlockMatrix mass_;
  std::vector<double> lumped_;  // M's diagonal where M is diagonal, empty otherwise
  sparse::BlockMatrix effective_;
  Dynamics dynamics_;
  double time_step_;
  std::vector<double> u_, v_, a_;
  std::vector<double> v_tilde_, a_tilde_;
  std::vector<double> inertia_;  // α·ṽ + ã, what M multiplies in f̂
};

// Ü at a given state: M·Ü = f − C·U̇ − K·U. A set-up call: it factorises a consistent M.
std::vector<double> consistent_acceleration(const sparse::BlockMatrix& stiffness,
                                            const sparse::BlockMatrix& mass,
                                            const Dynamics& dynamics, std::span<const double> u,
                                            std::span<const double> v, std::span<const double> f);

}  // namespace hvp::fem
