#include "models/tissue/model.h"

#include "models/tissue/newton_run.h"
#include "models/tissue/nonlinear_tissue.h"

namespace hvp::tissue {

void Model::declare(config::Visitor& v) {
  const auto of_kind =
      v.variant("kind", kind, law_names(),
                {"the material law: corotational turns with each element and is linear in strain; "
                 "st-venant-kirchhoff gives way under compression; the neo-hookean ones resist it "
                 "and differ in volume; fung stiffens exponentially",
                 "cures rotations at the least cost and is defined everywhere, docs/tissue.md"});
  of_kind.only({LawKind::fung}, [&] {
    v.quantity("exponent", parameters.exponent, config::Dimension::dimensionless,
               config::between(0, Parameters::kLargestExponent),
               {"b: a shear of γ multiplies the shear modulus by e^(b·γ²)",
                "the least of recorded meat pressed as a column, docs/tissue.md"});
  });
}

std::unique_ptr<fem::Tissue> make_tissue(const fem::Body& body, const std::optional<Model>& model,
                                         fem::ContactDiagonal diagonal,
                                         const std::optional<fem::Dynamics>& dynamics,
                                         double period_s, fem::Effort effort) {
  if (!model || model->linear()) {
    return std::make_unique<fem::LinearTissue>(body, diagonal, dynamics, period_s, effort);
  }
  return std::make_unique<NonlinearTissue>(body, model->kind, diagonal, dynamics, period_s,
                                           model->parameters);
}

std::unique_ptr<fem::ReferenceModel> make_reference(const fem::Body& body, const Model& model,
                                                    const std::optional<fem::Dynamics>& dynamics,
                                                    double period_s, std::size_t probes) {
  return std::make_unique<NewtonRun>(body, model.kind, dynamics, period_s, probes,
                                     model.parameters);
}

}  // namespace hvp::tissue
