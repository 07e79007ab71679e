#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "models/fem/hold.h"
#include "models/sparse/block_matrix.h"
#include "models/tissue/elastic_body.h"

namespace hvp::tissue {

// How a search for equilibrium ended.
struct Equilibrium {
  enum class End {
    converged,
    undefined_start,  // the law is not defined for the displacements to start from
    no_step,          // no step, however short, is defined and comes closer
    singular,         // the tangent cannot be factorised, nor the stiffness at rest
    too_many_steps
  };

  End end = End::converged;
  // The largest component of the residual before each step and after the last, N.
  std::vector<double> residual_n;
  int shortened = 0;    // steps that the line search made shorter
  int at_rest = 0;      // steps with the stiffness at rest, because the tangent was indefinite
  double energy_j = 0;  // Ψ of the result
  Deformation deformation = {};

  bool converged() const { return end == End::converged; }
  int steps() const { return static_cast<int>(residual_n.size()) - 1; }
};

// The static equilibrium f_int(u) = f of a body, with prescribed displacements, by Newton's method
// in double precision: the reference that other solvers are measured against. Each step factorises
// the exact tangent over the free nodes. A step is shortened until the law is defined everywhere
// (det F > 0 for neo-Hookean) and, once the prescribed displacements are reached, until the
// potential Ψ − fᵀu or the residual falls. Where the tangent is indefinite, at an instability or
// under strong compression, a step is made with the stiffness at rest instead, which is downhill.
class StaticEquilibrium {
 public:
  struct Settings {
    double tolerance = 1e-11;  // of the largest external or internal force of a node
    int most_steps = 60;
  };

  // Keeps a reference to the body.
  explicit StaticEquilibrium(const ElasticBody& body) : StaticEquilibrium(body, Settings()) {}
  StaticEquilibrium(const ElasticBody& body, Settings settings);

  // Searches from `u`, and leaves there the last displacements that it reached. `load` is the
  // external force in N, which does not follow the body; both are over active nodes. Of `hold` the
  // nodes and their displacements count.
  Equilibrium solve(std::span<const double> load, const fem::Hold& hold, std::span<double> u);

  // The internal forces over all mesh nodes at the result of the last solve(), N: at a prescribed
  // node the force that keeps it there, the external one on it included.
  std::span<const double> internal_forces() const { return internal_; }

 private:
  struct Point {
    double residual = 0;   // the largest component over free nodes, N
    double energy = 0;     // Ψ, J
    double potential = 0;  // Ψ − fᵀu, J
    double force = 0;      // the largest component of external and internal forces, N
    Deformation deformation = {};
  };

  void choose_free_nodes(const fem::Hold& hold);
  Point look_at(std::span<const double> u, std::span<const double> load);
  bool solve_with(const sparse::BlockMatrix& k, const fem::Hold& hold, bool need_definite);

  const ElasticBody& body_;
  Settings settings_;
  double rounding_n_;
  std::vector<int> free_;             // active nodes that can move, ascending
  std::vector<char> is_free_;         // by active node
  sparse::BlockMatrix tangent_;       // over active nodes
  std::vector<double> u_full_;        // m, over mesh nodes
  std::vector<double> internal_;      // N, over mesh nodes
  std::vector<double> residual_;      // N, over active nodes; zero at those that are not free
  std::vector<double> direction_;     // m, over active nodes
  std::vector<double> right_;         // N, over active nodes
  std::vector<Eigen::Vector3d> gap_;  // m, what prescribed nodes still have to move
};

}  // namespace hvp::tissue
