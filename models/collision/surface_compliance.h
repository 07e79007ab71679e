#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "models/fem/body.h"
#include "models/fem/direct_solver.h"
#include "models/sparse/block_matrix.h"

namespace hvp::collision {

// The compliance of a body's surface to point loads: the blocks (A⁻¹)_ij of a matrix that stays, K
// or Â, for pairs of surface nodes. Node numbers are the mesh's. A node without unknowns (anchored
// or prescribed) moves by no load and gives zero.
//
// Where the blocks of all pairs take `largest_table` bytes or less they stand in a table, which
// takes three solves a node at set-up. Of a larger body the columns of the nodes that were asked
// for last are kept, and a new node takes three solves. Copies share table and factors.
class SurfaceCompliance {
 public:
  static constexpr std::size_t kLargestTable = std::size_t{64} << 20;
  static constexpr std::size_t kKept = 64;  // columns: of eight probes, before and after a step

  // `surface_nodes` ascends. Throws InputError where A is not positive definite.
  SurfaceCompliance(const fem::Body& body, const sparse::BlockMatrix& a,
                    std::span<const int> surface_nodes, std::size_t largest_table = kLargestTable);

  // The displacement of `node` by a unit load at `other`, m/N. Allocates nothing.
  Eigen::Matrix3d block(int node, int other);
  bool has(int node) const { return slot_[static_cast<std::size_t>(node)] >= 0; }

  bool tabulated() const { return table_ != nullptr; }
  // Of the table, or of the columns that are kept.
  std::size_t bytes() const;
  // The solves so far, those of set-up included, and the additions and multiplications of one.
  std::int64_t solves() const { return solves_; }
  double solve_operations() const;

 private:
  struct Column {
    int slot = -1;
    std::int64_t asked = 0;
    std::vector<double> value;  // three for each slot, for each component of the load
  };

  void solve_for(int slot, std::span<double> column);
  const Column& column_of(int slot);

  std::shared_ptr<const fem::DirectSolver> solver_;
  std::vector<int> slot_;                             // of each mesh node; −1: none
  std::vector<int> active_;                           // of each slot, the node's unknowns
  std::shared_ptr<const std::vector<double>> table_;  // blocks (i, j), j <= i, row by row
  std::vector<Column> columns_;
  std::vector<double> x_;
  std::int64_t asked_ = 0;
  std::int64_t solves_ = 0;
};

}  // namespace hvp::collision
