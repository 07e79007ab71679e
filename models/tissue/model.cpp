#include "models/tissue/model.h"

#include <utility>
#include <vector>

#include "models/config/effects.h"
#include "models/config/input_error.h"
#include "models/tissue/elastic_body.h"
#include "models/tissue/explicit_tissue.h"
#include "models/tissue/newton_run.h"
#include "models/tissue/nonlinear_tissue.h"
#include "models/tissue/springs.h"

namespace hvp::tissue {

namespace {

// A law by its name, or springs in place of elements.
struct Choice {
  LawKind kind = LawKind::linear;
  bool springs = false;

  friend bool operator==(const Choice&, const Choice&) = default;
};

std::vector<std::pair<std::string_view, Choice>> choices() {
  std::vector<std::pair<std::string_view, Choice>> names;
  for (const auto& [name, kind] : law_names()) names.push_back({name, {kind}});
  names.push_back({"mass-spring", {LawKind::linear, true}});
  return names;
}

std::unique_ptr<PotentialBody> make_potential(const fem::Body& body,
                                              const std::optional<Model>& model) {
  if (model && model->springs) return std::make_unique<SpringBody>(body);
  return std::make_unique<ElasticBody>(body, model ? model->kind : LawKind::linear,
                                       model ? model->parameters : Parameters{});
}

}  // namespace

std::string_view name(const Model& model) {
  return model.springs ? "mass-spring" : name(model.kind);
}

void Model::check() const {
  check_prony(prony);
  if (springs && !prony.empty()) {
    throw InputError("prony", "springs have no memory: expected a law of elements");
  }
}

void Model::declare(config::Visitor& v) {
  Choice chosen{springs ? LawKind::linear : kind, springs};
  const auto of_kind =
      v.variant("kind", chosen, choices(),
                {"the material law: corotational turns with each element and is linear in strain; "
                 "st-venant-kirchhoff gives way under compression; the neo-hookean ones resist it "
                 "and differ in volume; fung stiffens exponentially; mass-spring has springs "
                 "along the edges, and needs host.solver = \"explicit\"",
                 "cures rotations at the least cost and is defined everywhere, docs/tissue.md"});
  kind = chosen.kind;
  springs = chosen.springs;
  of_kind.only({Choice{LawKind::fung}}, [&] {
    v.quantity("exponent", parameters.exponent, config::Dimension::dimensionless,
               config::between(0, Parameters::kLargestExponent),
               {"b: a shear of γ multiplies the shear modulus by e^(b·γ²)",
                "the least of recorded meat pressed as a column, docs/tissue.md"});
  });
  // One that is never renewed asks for nothing.
  std::vector<config::Need> needs;
  if (!matrix || matrix->present()) {
    needs = {{"host.solver",
              {"board", "cg", "cholesky", "inverse", "condensed"},
              "explicit steps have no matrix, and superposition is of a linear body"},
             {"refinement",
              {config::kPresent},
              "it is the matrix of the increments, which are its passes"}};
  }
  v.effect("matrix", matrix,
           {"the solver's matrix is formed anew of the deformed body, every so many frames",
            "of a renewal, after the force: the tangent of every element on the host, and all "
            "values of the matrix over the bus, or a host's new factors or inverse",
            std::move(needs)});
  v.list("prony", prony,
         {"terms of a relaxation: each takes a share of the force at once away in its time"});
}

std::unique_ptr<fem::Tissue> make_tissue(const fem::Body& body, const std::optional<Model>& model,
                                         fem::ContactDiagonal diagonal,
                                         const std::optional<fem::Dynamics>& dynamics,
                                         double period_s, fem::Effort effort) {
  if (!model || model->linear()) {
    return std::make_unique<fem::LinearTissue>(body, diagonal, dynamics, period_s, effort);
  }
  return std::make_unique<NonlinearTissue>(
      body, Constitution{model->kind, model->parameters, model->prony}, diagonal, dynamics,
      period_s);
}

std::unique_ptr<fem::Tissue> make_explicit_tissue(const fem::Body& body,
                                                  const std::optional<Model>& model,
                                                  fem::ContactDiagonal diagonal,
                                                  const fem::Dynamics& dynamics, double period_s,
                                                  int substeps) {
  if (model && !model->prony.empty()) {
    throw InputError("object.model.prony",
                     "explicit steps have no memory of forces: expected an implicit host.solver");
  }
  return std::make_unique<ExplicitTissue>(make_potential(body, model), diagonal, dynamics, period_s,
                                          substeps);
}

std::unique_ptr<fem::ReferenceModel> make_fine_steps(const fem::Body& body,
                                                     const std::optional<Model>& model,
                                                     const fem::Dynamics& dynamics, double period_s,
                                                     int substeps, std::size_t probes) {
  return std::make_unique<FineSteps>(make_potential(body, model), dynamics, period_s, substeps,
                                     probes);
}

std::unique_ptr<fem::ReferenceModel> make_reference(const fem::Body& body, const Model& model,
                                                    const std::optional<fem::Dynamics>& dynamics,
                                                    double period_s, std::size_t probes) {
  return std::make_unique<NewtonRun>(body, Constitution{model.kind, model.parameters, model.prony},
                                     dynamics, period_s, probes);
}

}  // namespace hvp::tissue
