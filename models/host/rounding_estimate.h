#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "models/config/figures.h"
#include "models/fem/body.h"
#include "models/sparse/block_matrix.h"
#include "models/stability/flag.h"

namespace hvp::host {

// Nodes (active, ascending) with one prescribed displacement, m. Without nodes only the loads act.
struct UnitContact {
  std::vector<int> nodes;
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
};

// The effect of the matrix' rounding to words on a body, before a frame is run.
struct RoundingEstimate {
  // Whether the board's matrix is positive definite, and whether the stiffness of a resting body
  // with that matrix is, to which an unrefined solve leads.
  bool positive_definite = false;
  bool resting_positive_definite = false;
  bool definite(bool refined) const {
    return positive_definite && (refined || resting_positive_definite);
  }
  int negative_eigenvalues = 0;
  int contacts = 0;  // number of contacts that were compared
  // The largest ‖u − u_true‖/‖u_true‖ of all contacts, and the same of the force. Empty where the
  // rounded stiffness is singular, or nothing was compared.
  struct Error {
    double displacement = 0;
    double force = 0;
  };
  std::optional<Error> error;

  // The flags of a rounding that is known to be bad and, where no reference measures its effect, of
  // one that moves a contact too far. Refinement corrects the rounding.
  stability::Flags flags(bool refined, bool measured) const;

  void report(config::Figures& f) const;
};

// Solves each contact twice in double precision, with the body's stiffness K and with that of the
// board's words. A is the matrix that is converted to words, Ã the matrix that they stand for: K of
// a static body. A dynamic body that rests has f̂ = f + (Â − K)·u, so that Ã·u = f̂ is (K + Ã −
// A)·u = f, which is true of both kinds of body: a rounding that is small beside Â may be large
// beside K. It takes at most three factorisations.
RoundingEstimate estimate_rounding(const fem::Body& body, const sparse::BlockMatrix& a,
                                   const sparse::BlockMatrix& rounded,
                                   std::span<const UnitContact> contacts);

}  // namespace hvp::host
