#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "models/fixed/remedy.h"
#include "models/fixed/solver.h"
#include "models/fixed/system.h"
#include "models/host/refinement.h"
#include "models/sparse/block_matrix.h"
#include "models/stability/flag.h"

namespace hvp::tables {

// The board and the host's half of a solve, with or without refinement.
class Board {
 public:
  // Keeps a reference to the matrix. Starts at zero displacement.
  Board(const sparse::BlockMatrix& matrix, const fixed::Plan& plan);

  // The system of prepare(), changed by the contact.
  const fixed::System& system() const { return system_; }

  // Sets the contact nodes, in ascending order. Their rows and columns are cleared, and those of
  // the previous contact nodes are restored.
  void set_contact(const std::vector<int>& contact);

  // Solves A·u = f with the contact nodes at u_c. Returns the flags that were raised.
  stability::Flags solve(std::span<const double> f, const Eigen::Vector3d& u_c);

  std::span<const double> displacement() const { return u_; }
  int iterations() const { return iterations_; }  // of all passes of the last solve

  // Computes b of the system with contact: f less the true matrix' columns, and for the contact
  // nodes the value with which the board's diagonal word gives u_c.
  void modified_load(std::span<const double> f, const Eigen::Vector3d& u_c,
                     std::span<double> b) const;

 private:
  stability::Flags run();
  stability::Flags solve_refined(std::span<const double> f, const Eigen::Vector3d& u_c);

  const sparse::BlockMatrix& matrix_;
  fem::LinearForces forces_;
  fixed::System system_;
  fixed::Scaling scaling_;
  std::unique_ptr<fixed::Solver> solver_;
  std::optional<host::RefinedSolve> refined_;
  std::vector<std::int32_t> x_, b_words_;
  std::vector<double> b_, u_;
  std::vector<int> contact_;
  std::vector<std::vector<std::int32_t>> rows_;  // original rows of the contact nodes
  int iterations_ = 0;
};

}  // namespace hvp::tables
