#pragma once

#include <limits>
#include <span>

#include "models/fem/body.h"
#include "models/sparse/block_matrix.h"
#include "models/tissue/operations.h"
#include "models/tissue/response.h"

namespace hvp::tissue {

// What a call found on its way through the elements.
struct Deformation {
  double smallest_determinant = std::numeric_limits<double>::infinity();  // det F; NaN if one is
  int inverted = 0;                                                       // det F not above zero
  // Elements for which the law is not defined, which add nothing, or whose det F is not a finite
  // number. The call's numbers are then no forces and no energy of this body.
  int undefined = 0;
  // Those of `undefined` that are not turned inside out: their law's energy is beyond its bound.
  int overflown = 0;
  int projected =
      0;  // elements whose tangent was not semidefinite, with Linearisation::semidefinite
  Operations operations = {};  // of this call

  bool defined() const { return undefined == 0; }
};

// A body whose displacements have an energy, whatever it is made of: who integrates over time asks
// for no more. Displacements (m) and forces (N) are over all mesh nodes, three each;
// fem::Body::expand() makes them from active ones. No call allocates.
class PotentialBody {
 public:
  virtual ~PotentialBody() = default;

  virtual const fem::Body& body() const = 0;
  // f = ∂Ψ/∂u. At an anchored or prescribed node it is the force with which its support acts on it.
  [[nodiscard]] virtual Deformation internal_forces(std::span<const double> u,
                                                    std::span<double> f) const = 0;
  // Ψ, J.
  [[nodiscard]] virtual Deformation energy(std::span<const double> u, double& energy_j) const = 0;
  // ∂f/∂u over the active nodes, N/m, symmetric to the last bit; `k` has the pattern of
  // fem::Body::stiffness(). Held nodes that the body keeps have that matrix' diagonal and nothing
  // else.
  [[nodiscard]] virtual Deformation tangent(std::span<const double> u, Linearisation linearisation,
                                            sparse::BlockMatrix& k) const = 0;
};

}  // namespace hvp::tissue
