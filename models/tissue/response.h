#pragma once

#include "models/tissue/element.h"
#include "models/tissue/operations.h"
#include "models/tissue/tensor.h"

namespace hvp::tissue {

// What a material law gives for one deformation gradient F. Where the law is not defined, the
// numbers are zero, but for det F.

// ψ, J/m³ of the body at rest.
template <class T>
struct Energy {
  T density{};
  T determinant{};  // det F
  bool defined = true;
  Operations operations = {};
};

// P = ∂ψ/∂F, the first Piola-Kirchhoff stress, Pa: force over the area at rest.
template <class T>
struct Stress {
  Tensor<T> p{};
  T determinant{};
  bool defined = true;
  Operations operations = {};
};

// The tangent of an element, K_ab = ∂f_a/∂u_b, N/m.
template <class T>
struct Tangent {
  Blocks<T> blocks{};
  T determinant{};
  bool defined = true;
  Operations operations = {};
};

// Which tangent. `warped` turns the linear one with the element, R·K·Rᵀ: it leaves out the change
// of R, so that it is semidefinite whatever the deformation, and Newton's method converges
// linearly. The laws without a rotation have the exact one alone. `semidefinite` is `warped` for a
// law that has it; of the others a body takes the negative eigenvalues away (semidefinite.h).
enum class Linearisation { exact, warped, semidefinite };

}  // namespace hvp::tissue
