#pragma once

#include <Eigen/Core>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "models/fem/assembly.h"
#include "models/fem/material.h"
#include "models/tissue/corotational.h"
#include "models/tissue/fung.h"
#include "models/tissue/linear.h"
#include "models/tissue/neo_hookean.h"
#include "models/tissue/st_venant_kirchhoff.h"

namespace hvp::tissue {

enum class LawKind {
  linear,
  corotational,
  st_venant_kirchhoff,
  neo_hookean_log,
  neo_hookean_isochoric,
  fung
};
const std::vector<std::pair<std::string_view, LawKind>>& law_names();
std::string_view name(LawKind kind);

// What a law has beside the material's small strains.
struct Parameters {
  // b of LawKind::fung: its shear modulus is μ·e^(b·(Ī₁ − 3)). 0 is NeoHookeanIsochoric.
  double exponent = 1;
  // At this b a shear of a tenth multiplies the modulus by e^100.
  static constexpr double kLargestExponent = 1e4;

  // Throws InputError for one that is not finite or out of range.
  void check() const;
};

// A hyperelastic, isotropic material: the energy ψ of a deformation gradient F = I + ∇u, its first
// derivative P and its second, as an element's tangent. For small strains every law is linear
// elasticity with the same Lamé constants; κ = λ + 2μ/3. A value type: who goes through many
// elements asks for the form once, and the compiler knows the law in the loop.
class Law {
 public:
  using Form = std::variant<Linear, Corotational, StVenantKirchhoff, NeoHookeanLog,
                            NeoHookeanIsochoric, Fung>;

  // Throws InputError for a material or a parameter out of range.
  Law(LawKind kind, const fem::Material& material, const Parameters& parameters = {});

  LawKind kind() const { return static_cast<LawKind>(form_.index()); }
  const Form& form() const { return form_; }
  // True if det F must be above zero.
  bool needs_positive_determinant() const { return kind() >= LawKind::neo_hookean_log; }

  // Nothing where the law is not defined.
  // ψ, J/m³ of the body at rest.
  std::optional<double> energy(const Eigen::Matrix3d& f) const;
  // P = ∂ψ/∂F, the first Piola-Kirchhoff stress, Pa.
  std::optional<Eigen::Matrix3d> stress(const Eigen::Matrix3d& f) const;
  // ∂f_a/∂u_b of an element, N/m.
  std::optional<fem::ElementMatrix> tangent(const Eigen::Matrix3d& f,
                                            const fem::ElementGeometry& geometry,
                                            Linearisation linearisation) const;

 private:
  Form form_;
};

}  // namespace hvp::tissue
