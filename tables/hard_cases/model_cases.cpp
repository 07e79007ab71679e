#include "tables/hard_cases/model_cases.h"

#include <algorithm>
#include <utility>

#include "models/tissue/elastic_body.h"
#include "models/tissue/stable_step.h"
#include "tables/hard_cases/moved_block.h"

namespace hvp::tables {

namespace {

using stability::Flag;
using tissue::LawKind;

const MovedBlock kStrike{.frames = 3, .reach = 6e-3, .way = strike};
const MovedBlock kThrough{.poisson_ratio = 0.3, .way = through};
const MovedBlock kIncompressible{
    .poisson_ratio = kLocked, .frames = 8, .reach = 6e-3, .way = press_a_little};
const MovedBlock kFloor{.layers = 1, .way = onto_the_floor};
const MovedBlock kTurn{.frames = 24, .reach = 1, .way = turn};
const MovedBlock kOnStiff{.contrast = 1e6, .reach = 6e-3, .way = press};
const MovedBlock kSlowPress{.reach = 6e-3, .way = press};

ModelPlan of_law(LawKind kind) {
  ModelPlan plan;
  plan.model.kind = kind;
  return plan;
}

ModelPlan by_steps(LawKind kind, bool springs = false) {
  ModelPlan plan = of_law(kind);
  plan.model.springs = springs;
  plan.explicit_steps = true;
  return plan;
}

ModelPlan generalised(ModelPlan plan) {
  plan.scheme = fem::Scheme::generalised_alpha;
  return plan;
}

ModelPlan step_doubled(ModelPlan plan) {
  plan.period_s *= 2;
  return plan;
}

ModelPlan locked(ModelPlan plan) {
  plan.poisson_ratio = kLocked;
  return plan;
}

// Half as many substeps as a body at rest asks for, each twice as long as is stable.
ModelPlan doubled(LawKind kind) {
  ModelPlan plan = by_steps(kind);
  const fem::Body body = body_of(kSlowPress);
  const double limit_s =
      tissue::largest_frequency(tissue::ElasticBody(body, kind), body.initial_displacement())
          .stable_step_s();
  plan.substeps = std::max(1, static_cast<int>(kPeriodS / (2 * limit_s)));
  return plan;
}

}  // namespace

std::vector<ModelCase> model_cases() {
  using enum LawKind;
  using enum Ending;
  const Flag inverted = Flag::inverted_element;
  const Flag unsolved = Flag::not_converged;
  // Fast strike and inversion end differently from law to law.
  struct Of {
    LawKind law;
    Ending strike;
    Ending through;
    Flag of_through;
  };
  std::vector<ModelCase> cases;
  for (const Of& of : {Of{corotational, remedied, remedied, unsolved},
                       Of{st_venant_kirchhoff, remedied, remedied, inverted},
                       Of{neo_hookean_log, remedied, remedied, inverted},
                       Of{neo_hookean_isochoric, remedied, remedied, inverted},
                       Of{fung, remedied, remedied, inverted}}) {
    const std::string kind(tissue::name(of.law));
    cases.push_back(made("fast strike, " + kind, "a third of a layer a frame: too few passes",
                         of.strike, unsolved, of_law(of.law), kStrike));
    cases.push_back(made("inversion, " + kind,
                         of.law == corotational ? "goes on"
                         : of.law == st_venant_kirchhoff
                             ? "goes on inside out, and says so"
                             : "no forces there: keeps the last solution",
                         of.through, of.of_through, of_law(of.law), kThrough));
    cases.push_back(made("ν = 0.4999, " + kind, "locked: volume's forces are all there is",
                         remedied, unsolved, locked(of_law(of.law)), kIncompressible));
    cases.push_back(made("90° rotation, " + kind, "the matrix at rest leads elsewhere", remedied,
                         inverted, of_law(of.law), kTurn));
  }
  cases.push_back(made("fast strike, generalised-α corotational",
                       "as with Newmark's rule: too few passes", remedied, unsolved,
                       generalised(of_law(corotational)), kStrike));
  cases.push_back(made("step doubled, generalised-α corotational",
                       "stable at any step; too few passes", remedied, unsolved,
                       step_doubled(generalised(of_law(corotational))), kSlowPress));
  cases.push_back(made("contrast 1e6, corotational", "stiff and soft turn alike: too few passes",
                       remedied, unsolved, of_law(corotational), kOnStiff));
  cases.push_back(made("fast strike, explicit neo-hookean-log", "the limit falls below the step",
                       remedied, Flag::unstable_step, by_steps(neo_hookean_log), kStrike));
  cases.push_back(made("inversion, explicit neo-hookean-log", "the limit falls far below the step",
                       remedied, Flag::unstable_step, by_steps(neo_hookean_log), kThrough));
  cases.push_back(made("ν = 0.4999, explicit corotational", "more substeps from the start",
                       converges, std::nullopt, locked(by_steps(corotational)), kIncompressible));
  cases.push_back(made("step doubled, explicit neo-hookean-log",
                       "refused at rest, with the number that is needed", remedied, std::nullopt,
                       doubled(neo_hookean_log), kSlowPress));
  cases.push_back(made("fast strike, mass-spring", "springs take it", converges, std::nullopt,
                       by_steps(linear, true), kStrike));
  cases.push_back(made("spring of length zero, mass-spring", "no direction, so no force", hopeless,
                       inverted, by_steps(linear, true), kFloor));
  cases.push_back(made("inversion, mass-spring", "springs do not see it", remedied, unsolved,
                       by_steps(linear, true), kThrough));
  cases.push_back(made("90° rotation, mass-spring", "turns with its springs", converges,
                       std::nullopt, by_steps(linear, true), kTurn));
  return cases;
}

}  // namespace hvp::tables
