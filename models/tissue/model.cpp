#include "models/tissue/model.h"

#include "models/tissue/newton_run.h"
#include "models/tissue/nonlinear_tissue.h"

namespace hvp::tissue {

void Model::declare(config::Visitor& v) {
  v.choice("kind", kind, law_names(),
           {"the material law: corotational turns with each element and is linear in strain; "
            "st-venant-kirchhoff gives way under compression; the neo-hookean ones resist it and "
            "differ in volume",
            "cures rotations at the least cost and is defined everywhere, docs/tissue.md"});
}

std::unique_ptr<fem::Tissue> make_tissue(const fem::Body& body, const std::optional<Model>& model,
                                         fem::ContactDiagonal diagonal,
                                         const std::optional<fem::Dynamics>& dynamics,
                                         double period_s, fem::Effort effort) {
  if (!model || model->linear()) {
    return std::make_unique<fem::LinearTissue>(body, diagonal, dynamics, period_s, effort);
  }
  return std::make_unique<NonlinearTissue>(body, model->kind, diagonal, dynamics, period_s);
}

std::unique_ptr<fem::ReferenceModel> make_reference(const fem::Body& body, const Model& model,
                                                    const std::optional<fem::Dynamics>& dynamics,
                                                    double period_s, std::size_t probes) {
  return std::make_unique<NewtonRun>(body, model.kind, dynamics, period_s, probes);
}

}  // namespace hvp::tissue
