#pragma once

#include <Eigen/Core>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "models/fem/hold.h"
#include "models/mesh/tet_mesh.h"
#include "models/sparse/block_matrix.h"

namespace hvp::fem {

// The diagonal of the contact nodes' rows (thesis §3.7 and its footnote): one, or the average of
// the matrix' diagonal entries, which keeps the condition number.
enum class ContactDiagonal { one, average };
const std::vector<std::pair<std::string_view, ContactDiagonal>>& contact_diagonal_names();

// Contact as a prescribed displacement (thesis §3.7, Fig. 3.5) of one node, or of a patch of nodes
// with one displacement u_c or one for each. The stiffness of one node goes to zero with the
// element size; that of a patch of fixed radius converges. A is K of a static body or Â of a
// dynamic one.
//
// No call allocates except modified_matrix. Nodes are active block rows of A; a node out of
// range throws InputError. A patch ascends and names each node once.
class ContactConstraint {
 public:
  // Keeps a reference to `a`, which must be symmetric and outlive this object.
  ContactConstraint(const sparse::BlockMatrix& a, ContactDiagonal diagonal);
  ContactConstraint(sparse::BlockMatrix&&, ContactDiagonal) = delete;

  double diagonal() const { return diagonal_; }

  // Fig. 3.5b: b = f − A[:, c]·u_c outside the contact, diagonal·u_c in its rows.
  void modified_rhs(std::span<const double> f, int node, const Eigen::Vector3d& u_c,
                    std::span<double> b) const;
  void modified_rhs(std::span<const double> f, std::span<const int> patch,
                    const Eigen::Vector3d& u_c, std::span<double> b) const;
  // The same with a displacement for each node of the patch.
  void modified_rhs(std::span<const double> f, std::span<const int> patch,
                    std::span<const Eigen::Vector3d> u, std::span<double> b) const;

  // A with the contact's rows and columns cleared and diagonal·I in its diagonal blocks. The
  // pattern stays A's, with zeros in cleared blocks, because the board's memory layout does not
  // move with the contact.
  sparse::BlockMatrix modified_matrix(int node) const;
  sparse::BlockMatrix modified_matrix(std::span<const int> patch) const;

  // Fig. 3.5c: the force in newtons ON the body at the contact, A_c·u − f_c with the original
  // rows, summed over a patch.
  Eigen::Vector3d reaction(std::span<const double> u, std::span<const double> f, int node) const;
  Eigen::Vector3d reaction(std::span<const double> u, std::span<const double> f,
                           std::span<const int> patch) const;
  // The same; each node's part is also stored in `forces`.
  Eigen::Vector3d reaction(std::span<const double> u, std::span<const double> f,
                           std::span<const int> patch, HeldForces& forces) const;

  // The additions and multiplications of one call; the copy of f is not counted.
  double modified_rhs_flops(int node) const;
  double modified_rhs_flops(std::span<const int> patch) const;
  double reaction_flops(int node) const;
  double reaction_flops(std::span<const int> patch) const;

 private:
  void check(std::span<const int> patch) const;
  Eigen::Vector3d reaction_of(std::span<const double> u, std::span<const double> f, int node) const;
  template <class Displacement>
  void move_columns(std::span<const double> f, std::span<const int> patch,
                    const Displacement& displacement, std::span<double> b) const;
  double blocks_of(std::span<const int> patch) const;

  const sparse::BlockMatrix& a_;
  double diagonal_;
};

// The mean of A's diagonal entries.
double mean_diagonal(const sparse::BlockMatrix& a);

// The nodes of the boundary within `radius` (m) of `node`, itself included, ascending: the
// footprint of a probe of that radius.
std::vector<int> contact_patch(const mesh::TetMesh& mesh, int node, double radius);

}  // namespace hvp::fem
