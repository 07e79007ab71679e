#pragma once

#include <span>

#include "models/config/declaration.h"
#include "models/sparse/block_matrix.h"

namespace hvp::fem {

// The scenario's effect [object.model.matrix]: how often the matrix of the increments is formed
// anew of the deformed body, and how far it may grow in the words of the one at rest.
struct MatrixRenewal {
  int every = 0;  // solved frames from one renewal to the next; 0: never
  double headroom = 1.25;

  bool present() const { return every > 0; }
  void declare(config::Visitor& v);
};

// What RenewableSystem::form() found.
struct FormedSystem {
  bool defined = true;  // false: elements had no tangent, and the matrix is of no use
  int projected = 0;    // elements whose tangent was indefinite, and was made semidefinite
  double operations = 0;
};

// A tissue whose system() can follow its deformation.
class RenewableSystem {
 public:
  virtual ~RenewableSystem() = default;

  // The matrix of a frame's equation for the body displaced so, positive semidefinite, into a
  // matrix with system()'s pattern, which it may not be. Does not allocate.
  virtual FormedSystem form(std::span<const double> u, sparse::BlockMatrix& a) = 0;
  // What form() takes of a body that is hardly strained, for what is known of a renewal
  // before the first frame. Allocates a matrix.
  virtual double typical_operations() = 0;
  // Makes this matrix system(), and raises the tissue's revision().
  virtual void take(const sparse::BlockMatrix& a) = 0;
};

}  // namespace hvp::fem
