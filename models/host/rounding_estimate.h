#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "models/config/figures.h"
#include "models/fem/body.h"
#include "models/sparse/block_matrix.h"

namespace hvp::host {

// Nodes (active, ascending) that are held at one displacement, m. Without nodes: the loads alone.
struct UnitContact {
  std::vector<int> nodes;
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
};

// What the rounding of the matrix to its words does to a body, before a frame is run.
struct RoundingEstimate {
  // Of the matrix that the board has, and of the stiffness that a resting body has with it, to
  // which an unrefined solve leads.
  bool positive_definite = false;
  bool resting_positive_definite = false;
  bool definite(bool refined) const {
    return positive_definite && (refined || resting_positive_definite);
  }
  int negative_eigenvalues = 0;
  int contacts = 0;  // compared
  // The largest of them, ‖u − u_true‖/‖u_true‖ and the same of the force; none where the rounded
  // stiffness is singular, or nothing was compared.
  struct Error {
    double displacement = 0;
    double force = 0;
  };
  std::optional<Error> error;

  void report(config::Figures& f) const;
};

// Solves each contact twice in double precision, with the body's stiffness K and with what the
// board's words make of it. A is the matrix that is put into words, Ã what they stand for: K of a
// static body. A dynamic body that rests has f̂ = f + (Â − K)·u, so that Ã·u = f̂ is
// (K + Ã − A)·u = f, which holds for both: a rounding that is small beside Â may be large beside K.
// Three factorisations at most.
RoundingEstimate estimate_rounding(const fem::Body& body, const sparse::BlockMatrix& a,
                                   const sparse::BlockMatrix& rounded,
                                   std::span<const UnitContact> contacts);

}  // namespace hvp::host
