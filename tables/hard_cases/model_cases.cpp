#include "tables/hard_cases/model_cases.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fem/structured_box.h"
#include "models/host/deviation.h"
#include "models/host/frame_computation.h"
#include "models/index.h"
#include "models/tissue/elastic_body.h"
#include "models/tissue/explicit_tissue.h"
#include "models/tissue/stable_step.h"

namespace hvp::tables {

namespace {

using Eigen::Vector3d;
using stability::Flag;
using stability::Flags;
using tissue::LawKind;

constexpr double kPeriodS = 2e-3;
constexpr double kCell = 5e-3;  // m

// A block of 20 × 20 × 10 mm, clamped below, and how nodes of its upper face are led: `way` gives
// their displacement at a part of the motion from 0 to 1, then they are held for as long again.
struct MovedBlock {
  double poisson_ratio = 0.45;
  double young_modulus_pa = 10e3;
  int layers = 2;
  int frames = 20;
  double reach = 1e-9;  // m, of the nodes that are led, from the upper face's centre
  Vector3d (*way)(double part, const Vector3d& node) = nullptr;
};

std::vector<int> lowest(const mesh::TetMesh& mesh) {
  std::vector<int> nodes;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (mesh.nodes[n].z() == 0) nodes.push_back(static_cast<int>(n));
  }
  return nodes;
}

fem::Body body_of(const MovedBlock& block) {
  mesh::TetMesh mesh =
      fem::structured_box({0.02, 0.02, kCell * block.layers}, {4, 4, block.layers});
  const std::vector<int> clamped = lowest(mesh);
  return fem::Body(std::move(mesh),
                   fem::Material{.young_modulus_pa = block.young_modulus_pa,
                                 .poisson_ratio = block.poisson_ratio},
                   clamped, fem::AnchorTreatment::removed);
}

fem::Dynamics dynamics() {
  fem::Dynamics d;
  d.newmark_beta = 0.605;
  d.newmark_gamma = 0.6;
  d.rayleigh_mass = 20;
  d.rayleigh_stiffness = 0;
  return d;
}

// The frames as a run makes them: increments with the matrix at rest, or explicit steps.
class Frames {
 public:
  Frames(std::unique_ptr<fem::Tissue> tissue, const ModelPlan& plan)
      : computation_(std::move(tissue), fixed::Settings{},
                     plan.explicit_steps
                         ? std::nullopt
                         : std::make_optional(host::Refinement{.passes = plan.passes}),
                     plan.explicit_steps ? host::SolvedBy::steps : host::SolvedBy::cholesky,
                     host::Effort::computed) {}

  Flags step(const fem::Hold& hold) {
    if (!std::ranges::equal(hold.nodes, computation_.contact())) {
      computation_.set_contact(hold.nodes);
    }
    computation_.hold(hold);
    computation_.begin();
    host::FrameMethod& method = computation_.method();
    while (method.next({})) {
    }
    force_ = computation_.force();
    method.finish();
    computation_.update();
    return method.flags();
  }
  const host::FrameComputation& computation() const { return computation_; }
  bool finite() const {
    const auto is_finite = [](double u) { return std::isfinite(u); };
    return force_.allFinite() && std::ranges::all_of(computation_.displacement(), is_finite);
  }

 private:
  host::FrameComputation computation_;
  Vector3d force_ = Vector3d::Zero();
};

// The frames of a motion, or of the truth about them.
struct Trajectory {
  std::vector<std::vector<double>> displacement;
  std::int64_t unsolved = 0;
};

class Motion {
 public:
  explicit Motion(const MovedBlock& block) : block_(block), body_(body_of(block)) {
    const Vector3d top(0.01, 0.01, kCell * block.layers);
    for (int a = 0; a < body_.active_nodes(); ++a) {
      const Vector3d x = body_.mesh().nodes[at(body_.node_of_active()[at(a)])] - top;
      if (x.z() != 0 || x.norm() > block.reach) continue;
      nodes_.push_back(a);
      from_top_.push_back(x);
    }
    places_.resize(nodes_.size());
  }

  ModelOutcome attempt(const ModelPlan& plan);

 private:
  int frames(const ModelPlan& plan) const { return 2 * block_.frames * plan.slower; }
  fem::Hold hold(int frame, const ModelPlan& plan) {
    const double part = std::min(1.0, 2.0 * frame / frames(plan));
    for (std::size_t n = 0; n < nodes_.size(); ++n) places_[n] = block_.way(part, from_top_[n]);
    return {nodes_, places_, {}, kPeriodS};
  }
  std::unique_ptr<fem::Tissue> tissue(const ModelPlan& plan) const {
    return plan.explicit_steps
               ? tissue::make_explicit_tissue(body_, plan.model, fem::ContactDiagonal::average,
                                              dynamics(), kPeriodS, plan.substeps)
               : tissue::make_tissue(body_, plan.model, fem::ContactDiagonal::average, dynamics(),
                                     kPeriodS, fem::Effort::computed);
  }
  const Trajectory& truth(const ModelPlan& plan, int substeps);

  MovedBlock block_;
  fem::Body body_;
  std::vector<int> nodes_;
  std::vector<Vector3d> from_top_, places_;
  // By what they depend on: the law, the pace and the substeps.
  std::map<std::tuple<std::string, int, int>, Trajectory> truths_;
};

const Trajectory& Motion::truth(const ModelPlan& plan, int substeps) {
  const auto [found, is_new] =
      truths_.try_emplace({std::string(name(plan.model)), plan.slower, substeps});
  Trajectory& truth = found->second;
  if (!is_new) return truth;
  const std::unique_ptr<fem::ReferenceModel> run =
      substeps > 0 ? tissue::make_fine_steps(body_, plan.model, dynamics(), kPeriodS, substeps, 1)
                   : tissue::make_reference(body_, plan.model, dynamics(), kPeriodS, 1);
  for (int frame = 1; frame <= frames(plan); ++frame) {
    run->step(hold(frame, plan));
    truth.displacement.emplace_back(run->displacement().begin(), run->displacement().end());
  }
  truth.unsolved = run->unsolved();
  return truth;
}

ModelOutcome Motion::attempt(const ModelPlan& plan) {
  ModelOutcome outcome;
  std::unique_ptr<Frames> run;
  try {
    run = std::make_unique<Frames>(tissue(plan), plan);
  } catch (const InputError& error) {
    outcome.refusal = error.key().empty() ? error.what() : error.key() + ": " + error.what();
    return outcome;
  }
  const fem::ExplicitSteps* steps = run->computation().explicit_steps();
  const Trajectory& truth = this->truth(plan, steps != nullptr ? steps->substeps() : 0);
  host::Deviation deviation;
  for (int frame = 1; frame <= frames(plan); ++frame) {
    outcome.run.merge(run->step(hold(frame, plan)));
    outcome.finite = outcome.finite && run->finite();
    const std::vector<double>& expected = truth.displacement[at(frame - 1)];
    deviation.add(run->computation().displacement(), expected);
  }
  outcome.unsolved = static_cast<int>(truth.unsolved);
  outcome.error = deviation.relative();
  if (steps != nullptr) {
    outcome.least_limit_s = steps->least_limit_s();
    outcome.substeps = steps->substeps();
  }
  if (outcome.unsolved > 0 || !outcome.error || !(*outcome.error <= kBound)) {
    outcome.reference.raise(Flag::not_converged);
  }
  return outcome;
}

// 5 mm in three frames.
Vector3d strike(double part, const Vector3d& /*node*/) { return {0, 0, -5e-3 * part}; }
// One node past the one below it.
Vector3d through(double part, const Vector3d& /*node*/) { return {0, 0, -1.3 * kCell * part}; }
Vector3d press(double part, const Vector3d& /*node*/) { return {0, 0, -2e-3 * part}; }
Vector3d press_a_little(double part, const Vector3d& /*node*/) { return {0, 0, -2e-4 * part}; }
// Onto the floor, where a clamped node is.
Vector3d onto_the_floor(double part, const Vector3d& /*node*/) { return {0, 0, -kCell * part}; }
// The upper face about its own axis.
Vector3d turn(double part, const Vector3d& node) {
  const double angle = std::numbers::pi / 2 * part;
  return {std::cos(angle) * node.x() - std::sin(angle) * node.y() - node.x(),
          std::sin(angle) * node.x() + std::cos(angle) * node.y() - node.y(), 0};
}

constexpr double kLocked = 0.4999;
constexpr double kUnlocked = 0.45;

const MovedBlock kStrike{.frames = 3, .reach = 6e-3, .way = strike};
const MovedBlock kThrough{.poisson_ratio = 0.3, .way = through};
const MovedBlock kIncompressible{
    .poisson_ratio = kLocked, .frames = 8, .reach = 6e-3, .way = press_a_little};
const MovedBlock kFloor{.layers = 1, .way = onto_the_floor};
const MovedBlock kTurn{.frames = 24, .reach = 1, .way = turn};
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

ModelPlan locked(ModelPlan plan) {
  plan.poisson_ratio = kLocked;
  return plan;
}

MovedBlock with_ratio(MovedBlock block, double poisson_ratio) {
  block.poisson_ratio = poisson_ratio;
  return block;
}

ModelCase made(std::string name, std::string expected, Ending ending, std::optional<Flag> flag,
               const ModelPlan& plan, const MovedBlock& block) {
  return {
      std::move(name),
      std::move(expected),
      ending,
      flag,
      plan,
      [as_given = std::make_shared<Motion>(block),
       unlocked = std::make_shared<Motion>(with_ratio(block, kUnlocked))](const ModelPlan& with) {
        return (with.poisson_ratio == kUnlocked ? unlocked : as_given)->attempt(with);
      }};
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

std::string difference(const ModelPlan& from, const ModelPlan& to) {
  std::vector<std::string> changes;
  if (name(from.model) != name(to.model)) {
    changes.push_back(fmt::format("object.model.kind = \"{}\"", name(to.model)));
  }
  if (from.passes != to.passes) {
    changes.push_back(fmt::format("refinement.passes = {}", to.passes));
  }
  if (from.substeps != to.substeps) {
    changes.push_back(fmt::format("host.substeps = {}", to.substeps));
  }
  if (from.poisson_ratio != to.poisson_ratio) {
    changes.push_back(fmt::format("object.material.poisson_ratio = {:g}", to.poisson_ratio));
  }
  if (from.slower != to.slower) {
    changes.push_back(fmt::format("a probe {} times as slow", to.slower / from.slower));
  }
  return fmt::format("{}", fmt::join(changes, ", "));
}

namespace {

// What the flags' texts name first that is not done yet.
std::optional<ModelPlan> next_plan(const ModelPlan& plan, const ModelOutcome& outcome) {
  constexpr int kSlowest = 2;
  constexpr int kMostSubsteps = 512;
  constexpr int kMostPasses = 16;  // the most that a scenario may ask for
  ModelPlan next = plan;
  const Flags flags = outcome.flags();
  if (plan.poisson_ratio > kUnlocked) {
    next.poisson_ratio = kUnlocked;  // what the flag `locking` names, which a run has at set-up
    return next;
  }
  if (!outcome.refusal.empty()) {
    if (!plan.explicit_steps || plan.substeps == 0) return std::nullopt;
    next.substeps = 0;  // the message offers it
    return next;
  }
  if (plan.explicit_steps && flags.has(Flag::unstable_step)) {
    const auto needed = static_cast<int>(
        std::ceil(kPeriodS / std::max(tissue::ExplicitTissue::kShare * outcome.least_limit_s,
                                      kPeriodS / kMostSubsteps)));
    if (needed > outcome.substeps) {
      next.substeps = needed;
      return next;
    }
  }
  if (flags.has(Flag::inverted_element) && plan.slower < kSlowest) {
    next.slower = 2 * plan.slower;
    return next;
  }
  if (plan.explicit_steps) {
    if (flags.has(Flag::inverted_element) || outcome.substeps >= kMostSubsteps) {
      return std::nullopt;
    }
    next.substeps = 2 * outcome.substeps;
    return next;
  }
  if (plan.passes < kMostPasses) {
    next.passes = 2 * plan.passes;
    return next;
  }
  if (plan.slower < kSlowest) {
    next.slower = 2 * plan.slower;
    return next;
  }
  if (!flags.has(Flag::inverted_element) || plan.model.kind == LawKind::corotational) {
    return std::nullopt;
  }
  next.model.kind = LawKind::corotational;
  return next;
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
                       Of{neo_hookean_log, hopeless, hopeless, inverted},
                       Of{neo_hookean_isochoric, hopeless, hopeless, inverted},
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
    cases.push_back(made("90° rotation, " + kind,
                         "the matrix at rest leads elsewhere: not for one that is not renewed",
                         hopeless, inverted, of_law(of.law), kTurn));
  }
  cases.push_back(made("fast strike, explicit neo-hookean-log", "the limit falls below the step",
                       remedied, Flag::unstable_step, by_steps(neo_hookean_log), kStrike));
  cases.push_back(made("inversion, explicit neo-hookean-log", "the limit falls far below the step",
                       remedied, inverted, by_steps(neo_hookean_log), kThrough));
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

ModelTrail follow(const ModelCase& hard_case) {
  constexpr int kMost = 12;
  ModelTrail trail;
  trail.plan = hard_case.plan;
  trail.first = hard_case.attempt(trail.plan);
  trail.last = trail.first;
  trail.attempts = 1;
  while (!trail.last.converged() && trail.attempts < kMost) {
    const std::optional<ModelPlan> next = next_plan(trail.plan, trail.last);
    if (!next) break;
    trail.plan = *next;
    trail.last = hard_case.attempt(trail.plan);
    ++trail.attempts;
  }
  return trail;
}

}  // namespace hvp::tables
