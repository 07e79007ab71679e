#pragma once

#include <memory>
#include <optional>

#include "models/config/declaration.h"
#include "models/fem/reference_model.h"
#include "models/fem/tissue.h"
#include "models/tissue/law.h"

namespace hvp::tissue {

// What the body does under load: the scenario's effect [object.model]. Without it the body is
// linear, as in the thesis.
struct Model {
  LawKind kind = LawKind::corotational;
  Parameters parameters = {};

  bool linear() const { return kind == LawKind::linear; }
  void declare(config::Visitor& v);
};

// A body in the servo loop, and the same in double precision by Newton's method, with which its
// frames are compared. Both keep a reference to the body. `model` absent: linear. They throw
// InputError for an unstable time integration.
std::unique_ptr<fem::Tissue> make_tissue(const fem::Body& body, const std::optional<Model>& model,
                                         fem::ContactDiagonal diagonal,
                                         const std::optional<fem::Dynamics>& dynamics,
                                         double period_s, fem::Effort effort);
// `model` must be one that is not linear.
std::unique_ptr<fem::ReferenceModel> make_reference(const fem::Body& body, const Model& model,
                                                    const std::optional<fem::Dynamics>& dynamics,
                                                    double period_s, std::size_t probes);

}  // namespace hvp::tissue
