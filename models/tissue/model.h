#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "models/config/declaration.h"
#include "models/fem/reference_model.h"
#include "models/fem/renewal.h"
#include "models/fem/tissue.h"
#include "models/tissue/law.h"
#include "models/tissue/prony.h"

namespace hvp::tissue {

// What the body does under load: the scenario's effect [object.model]. Without it the body is
// linear, as in the thesis.
struct Model {
  LawKind kind = LawKind::corotational;
  bool springs = false;  // in place of elements: `kind` does not matter
  Parameters parameters = {};
  std::vector<PronyTerm> prony;
  std::optional<fem::MatrixRenewal> matrix;  // absent: that of the body at rest

  // True if its forces are K·u.
  bool linear() const { return kind == LawKind::linear && !springs && prony.empty(); }
  void declare(config::Visitor& v);
  void check() const;
};

// "corotational", or "mass-spring".
std::string_view name(const Model& model);

// A body in the servo loop, and the same in double precision by Newton's method, with which its
// frames are compared. Both keep a reference to the body. `model` absent: linear. They throw
// InputError for an unstable time integration.
std::unique_ptr<fem::Tissue> make_tissue(const fem::Body& body, const std::optional<Model>& model,
                                         fem::ContactDiagonal diagonal,
                                         const std::optional<fem::Dynamics>& dynamics,
                                         double period_s, fem::Effort effort);
// The same by explicit time steps; `substeps` a frame, 0: as many as are stable. The reference has
// four times as many. Throws InputError with the scenario's key for what they cannot do.
std::unique_ptr<fem::Tissue> make_explicit_tissue(const fem::Body& body,
                                                  const std::optional<Model>& model,
                                                  fem::ContactDiagonal diagonal,
                                                  const fem::Dynamics& dynamics, double period_s,
                                                  int substeps);
std::unique_ptr<fem::ReferenceModel> make_fine_steps(const fem::Body& body,
                                                     const std::optional<Model>& model,
                                                     const fem::Dynamics& dynamics, double period_s,
                                                     int substeps, std::size_t probes);
// `model` must be one that is not linear.
std::unique_ptr<fem::ReferenceModel> make_reference(const fem::Body& body, const Model& model,
                                                    const std::optional<fem::Dynamics>& dynamics,
                                                    double period_s, std::size_t probes);

}  // namespace hvp::tissue
