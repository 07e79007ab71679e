#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "models/fixed/remedy.h"
#include "models/fixed/scaling.h"
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

  // As prepare() made it and the contact has changed it.
  const fixed::System& system() const { return system_; }

  // The nodes that follow, ascending: their rows and columns are cleared, those of the nodes
  // before are put back.
  void set_contact(const std::vector<int>& contact);

  // A·u = f with the contact at u_c. Returns the flags that came up.
  stability::Flags solve(std::span<const double> f, const Eigen::Vector3d& u_c);

  std::span<const double> displacement() const { return u_; }
  int iterations() const { return iterations_; }  // of the last solve, all passes

  // b of the system with the contact in it: f less the true matrix' columns, and for the contact
  // what makes the board's diagonal word give u_c.
  void modified_load(std::span<const double> f, const Eigen::Vector3d& u_c,
                     std::span<double> b) const;

 private:
  stability::Flags run();
  stability::Flags solve_refined(std::span<const double> f, const Eigen::Vector3d& u_c);

  const sparse::BlockMatrix& matrix_;
  fixed::System system_;
  fixed::Scaling scaling_;
  std::unique_ptr<fixed::Solver> solver_;
  std::optional<host::RefinedSolve> refined_;
  std::vector<std::int32_t> x_, b_words_;
  std::vector<double> b_, u_;
  std::vector<int> contact_;
  std::vector<std::vector<std::int32_t>> rows_;  // of the contact's nodes, as they were
  int iterations_ = 0;
};

}  // namespace hvp::tables
