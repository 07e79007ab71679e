#pragma once

#include <Eigen/Core>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "models/config/declaration.h"
#include "models/fem/assembly.h"
#include "models/fem/hold.h"
#include "models/sparse/block_matrix.h"

namespace hvp::fem {

// The rule of the time integration: Newmark's, thesis §3.6.1, or Chung and Hulbert's generalised-α.
enum class Scheme { newmark, generalised_alpha };
const std::vector<std::pair<std::string_view, Scheme>>& scheme_names();

// Inertia and damping: the scenario's effect [dynamics]. Without it the body is static.
//
// β and γ are in Zienkiewicz's convention, that of thesis (3.24)–(3.29): β here is twice the β of
// Newmark's and Hughes' books. The average-acceleration rule is β = γ = ½; the textbook's β = ¼
// is only conditionally stable here.
struct Dynamics {
  Scheme scheme = Scheme::newmark;
  double spectral_radius = 0.8;  // ρ∞ of generalised-α
  double newmark_beta = 0.5;     // of Newmark's rule; generalised-α makes both from ρ∞
  double newmark_gamma = 0.5;
  MassKind mass = MassKind::lumped;
  double rayleigh_mass = 0.1;        // 1/s, α of C = α·M + β·K, thesis (3.22)
  double rayleigh_stiffness = 1e-3;  // s, β of (3.22)

  void declare(config::Visitor& v);

  // Throws InputError for parameters that are not stable at every time step: the exact condition
  // without damping is β ≥ γ ≥ ½. Parameters between that and the sufficient condition (3.29)
  // are accepted: the highest modes then decay without oscillating, at two different rates.
  // Generalised-α is stable at every step for ρ∞ from 0 to 1.
  void check() const;

  // The largest ω·Δt at which an undamped mode of angular frequency ω stays bounded:
  // √(2/(γ − β)) for β < γ, infinity for β ≥ γ and for generalised-α. Zero for γ < ½, where energy
  // grows at any step.
  double critical_frequency() const;

  // The numbers of the scheme. The equation of motion is fulfilled between the step's ends, at
  //   (1 − α_m)·Ü(n+1) + α_m·Ü(n)  and  (1 − α_f)·(U, U̇, f)(n+1) + α_f·(U, U̇, f)(n).
  // Newmark's rule has α_m = α_f = 0, its end. Generalised-α has (Chung, Hulbert 1993, (17), (20),
  // (25), with their β doubled)
  //   α_m = (2ρ∞ − 1)/(ρ∞ + 1), α_f = ρ∞/(ρ∞ + 1), γ = ½ − α_m + α_f, β = ½·(1 − α_m + α_f)².
  struct Parameters {
    double beta;
    double gamma;
    double alpha_m;
    double alpha_f;
  };
  Parameters parameters() const;

 private:
  void check_newmark() const;
};

// Newmark's time integration of M·Ü + C·U̇ + K·U = f, thesis §3.6.1, with C = α·M + β·K. One step:
//
//   predict();                      // ã, ṽ from the present state, (3.26)
//   rhs(f, f_hat);                  // f̂ = f − C·ṽ − M·ã
//   hold(hold, f_hat);              // at nodes with a prescribed displacement
//   … solve Â·u = f̂ …               // (3.27), by some solver
//   update(u);                      // (3.25)
//
// f is the external force at the step's end with the sign of (3.20), not of (3.23). The thesis
// lost the tildes of ã and ṽ in (3.25), (3.26) and (3.28). No step allocates.
//
// Generalised-α takes the same steps with u at the step's end as its unknown. Its equation, divided
// by 1 − α_f, is
//   w·M·ü + C·u̇ + q(u) + s·(C·u̇ₙ + q(uₙ)) + z·M·üₙ = f + s·fₙ,
//   w = (1 − α_m)/(1 − α_f) = 2 − ρ∞,  z = α_m/(1 − α_f) = 2ρ∞ − 1,  s = α_f/(1 − α_f) = ρ∞,
// with q(u) = K·u, or the forces of elements at both ends of the step and not at the displacement
// between them. So Â differs in the weight of M alone, q(u) is formed where Newmark's rule forms
// it, and f̂ has what the step's start leaves. Â·u − f̂ at a held node is 1 + s times the force at
// t + (1 − α_f)·Δt: end_force() is the one at the step's end. Newmark's rule is w = 1, z = s = 0.
class Newmark {
 public:
  // K (N/m) and M (kg) over the same nodes; M's pattern lies within K's. The state starts at
  // rest with zero displacement. Throws InputError for an unstable rule or a Δt that is not
  // positive and finite.
  Newmark(const sparse::BlockMatrix& stiffness, const sparse::BlockMatrix& mass,
          const Dynamics& dynamics, double time_step_s);

  // Â = w·2/(βΔt²)·M + 2γ/(βΔt)·C + K, thesis (3.28), in K's pattern.
  const sparse::BlockMatrix& effective_matrix() const { return effective_; }

  void predict();
  // Forms f̂ for a constant f. f and f_hat do not overlap.
  void rhs(std::span<const double> f, std::span<double> f_hat);
  // The same of a body whose forces q are not K·u; `q` are those at the step's start, damping with
  // stiffness included, N. Newmark's rule does not look at them.
  void rhs(std::span<const double> f, std::span<const double> q, std::span<double> f_hat) const;
  // Sets velocity and acceleration of prescribed nodes. Such a node has no equation of motion: its
  // displacement u' is given, and Newmark's recursion of its velocity and acceleration neither
  // converges nor, for γ = ½, decays, so that each jump of u' rings in the force. Its velocity
  // becomes the mean one, (u' − u)/elapsed, and its acceleration zero:
  //   q = (u' − u)/elapsed − (ṽ + 2γ/(βΔt)·u'),   p = −(ã + 2/(βΔt²)·u'),
  //   ṽ += q,   ã += p,   f̂ −= C·q + M·p,
  // so that (3.25) and (3.27) stay unchanged, and the force at the node has no inertia of its own.
  // p counts w-fold in f̂. Changes nothing if hold.elapsed_s is zero. It may be called again before
  // update(): q and p are relative to the present ṽ and ã.
  void hold(const Hold& hold, std::span<double> f_hat);
  void update(std::span<const double> u_next);

  std::span<const double> displacement() const { return u_; }  // m
  std::span<const double> velocity() const { return v_; }      // m/s
  std::span<const double> acceleration() const { return a_; }  // m/s²
  void set_state(std::span<const double> u, std::span<const double> v, std::span<const double> a);

  // The force in newtons that holds a node at the end of the step that u ends:
  //   K·u + C·u̇ + M·ü − f in the node's rows. f is the constant external force.
  Eigen::Vector3d end_force(std::span<const double> u, std::span<const double> f, int node) const;
  // Its part M·(ü + α·u̇).
  Eigen::Vector3d end_inertia(std::span<const double> u, int node) const;

  Scheme scheme() const { return dynamics_.scheme; }
  // False for Newmark's rule, whose equation of motion is that of the step's end.
  bool between_ends() const { return between_ends_; }
  // s: the share of the step's start, of its forces and of the external ones.
  double start_share() const { return s_; }

  // The energy ½·U̇ᵀM·U̇ + ½·UᵀK·U in joules.
  double energy() const;

  double time_step_s() const { return time_step_; }

  // The velocity that a displacement u of this step has, ṽ + velocity_weight()·u, m/s.
  std::span<const double> predicted_velocity() const { return v_tilde_; }
  double velocity_weight() const { return 2 * gamma_ / (beta_ * time_step_); }
  // w·2/(βΔt²) + 2γα/(βΔt), 1/s²: what M has in Â.
  double inertia_weight() const;
  // What Â has besides the elastic and the damping forces of K: q += inertia_weight()·M·u, for all
  // nodes or for one.
  void add_inertia(std::span<const double> u, std::span<double> q) const;
  Eigen::Vector3d inertia(std::span<const double> u, int node) const;
  // The same entries in a matrix of K's pattern.
  void add_inertia_to(sparse::BlockMatrix& matrix) const;
  double inertia_flops() const;

  // The additions and multiplications of one call. The sparse products dominate: 18 for each block
  // of K (none without stiffness damping) and, with the consistent mass, 18 for each block of M.
  double predict_flops() const;
  double rhs_flops() const;            // of a body whose forces are K·u
  double rhs_flops_of_forces() const;  // of another one
  double update_flops() const;
  double hold_flops(const Hold& hold) const;
  double end_force_flops(std::span<const int> nodes) const;
  double end_inertia_flops(std::span<const int> nodes) const;

 private:
  double acceleration_weight() const { return 2 / (beta_ * time_step_ * time_step_); }
  void subtract_inertia(std::span<double> f_hat) const;

  sparse::BlockMatrix stiffness_;
  sparse::BlockMatrix mass_;
  std::vector<double> lumped_;  // M's diagonal if M is diagonal, otherwise empty
  sparse::BlockMatrix effective_;
  Dynamics dynamics_;
  double beta_, gamma_;
  bool between_ends_;
  double w_, z_, s_;
  double time_step_;
  std::vector<double> u_, v_, a_;
  std::vector<double> v_tilde_, a_tilde_;
  std::vector<double> inertia_;  // α·(ṽ + s·v) + w·ã + z·a, which M multiplies in f̂
  std::vector<double> elastic_;  // β·(ṽ + s·v) + s·u, which K multiplies; empty for Newmark's rule
};

// Ü in a given state: M·Ü = f − C·U̇ − K·U. A set-up call, which factorises a consistent M.
std::vector<double> consistent_acceleration(const sparse::BlockMatrix& stiffness,
                                            const sparse::BlockMatrix& mass,
                                            const Dynamics& dynamics, std::span<const double> u,
                                            std::span<const double> v, std::span<const double> f);

}  // namespace hvp::fem
