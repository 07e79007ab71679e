#include "tables/hard_cases/moved_block.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <numbers>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "models/config/input_error.h"
#include "models/fem/materials.h"
#include "models/fem/structured_box.h"
#include "models/host/deviation.h"
#include "models/host/frame_computation.h"
#include "models/host/word_board.h"
#include "models/index.h"
#include "models/tissue/elastic_body.h"
#include "models/tissue/explicit_tissue.h"

namespace hvp::tables {

namespace {

using Eigen::Vector3d;
using stability::Flag;
using stability::Flags;

std::vector<int> lowest(const mesh::TetMesh& mesh) {
  std::vector<int> nodes;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (mesh.nodes[n].z() == 0) nodes.push_back(static_cast<int>(n));
  }
  return nodes;
}

fem::Dynamics dynamics(const ModelPlan& plan) {
  fem::Dynamics d;
  d.scheme = plan.scheme;
  d.newmark_beta = 0.605;
  d.newmark_gamma = 0.6;
  d.rayleigh_mass = 20;
  d.rayleigh_stiffness = 0;
  return d;
}

// The thesis' words or wider ones, with Jacobi's preconditioner and a range of six times the
// strike.
fixed::Settings words_of(const ModelPlan& plan) {
  fixed::Settings settings;
  settings.method = fixed::Method::jacobi_pcg;
  settings.iterations = 80;
  settings.matrix_bits = plan.matrix_bits;
  settings.vector_bits = plan.matrix_bits + 4;
  if (plan.scaled) settings.matrix_scaling = fixed::MatrixScaling::diagonal;
  settings.displacement_range = 0.03;
  return settings;
}

host::SolvedBy solver_of(const ModelPlan& plan) {
  if (plan.explicit_steps) return host::SolvedBy::steps;
  return plan.board ? host::SolvedBy::board : host::SolvedBy::cholesky;
}

// The frames as a run makes them: increments with the matrix at rest or a renewed one, or explicit
// steps.
class Frames {
 public:
  Frames(std::unique_ptr<fem::Tissue> tissue, const ModelPlan& plan)
      : computation_(std::move(tissue), plan.board ? words_of(plan) : fixed::Settings{},
                     plan.explicit_steps
                         ? std::nullopt
                         : std::make_optional(host::Refinement{.passes = plan.passes}),
                     solver_of(plan), host::Effort::computed, plan.renewal) {
    if (!plan.board) return;
    board_.emplace(computation_.board().matrix(), computation_.board().settings());
    b_.resize(computation_.displacement().size());
  }

  Flags step(const fem::Hold& hold) {
    if (!std::ranges::equal(hold.nodes, computation_.contact())) {
      computation_.set_contact(hold.nodes);
      if (board_) board_->set_contact(hold.nodes, computation_.board().diagonal_word());
    }
    computation_.hold(hold);
    computation_.begin();
    host::FrameMethod& method = computation_.method();
    while (method.next(b_)) {
      const fixed::Report report = board_->solve(b_);
      method.accept(board_->solution(), report.flags);
    }
    force_ = computation_.force();
    method.finish();
    Flags flags = method.flags();
    computation_.update();
    if (computation_.renewal_is_due()) {
      flags.merge(computation_.renew());
      if (board_)
        board_->renew(computation_.board().matrix(), computation_.board().diagonal_word());
    }
    return flags;
  }
  const host::FrameComputation& computation() const { return computation_; }
  bool finite() const {
    const auto is_finite = [](double u) { return std::isfinite(u); };
    return force_.allFinite() && std::ranges::all_of(computation_.displacement(), is_finite);
  }

 private:
  host::FrameComputation computation_;
  std::optional<host::WordBoard> board_;
  std::vector<std::int32_t> b_;  // empty where the host solves
  Vector3d force_ = Vector3d::Zero();
};

// The frames of a motion, or of the truth about them.
struct Trajectory {
  std::vector<std::vector<double>> displacement;
  std::int64_t unsolved = 0;
  double least_determinant = 1;  // det F of any element
};

class LedBlock {
 public:
  explicit LedBlock(const MovedBlock& block) : block_(block), body_(body_of(block)) {
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
  // In frames of the plan's length, at its pace.
  static int paced(int frames, const ModelPlan& plan) {
    return static_cast<int>(std::lround(frames * plan.slower * kPeriodS / plan.period_s));
  }
  int frames(const ModelPlan& plan) const {
    return paced(block_.frames + (block_.rest < 0 ? block_.frames : block_.rest), plan);
  }
  fem::Hold hold(int frame, const ModelPlan& plan) {
    const double part = std::min(1.0, 1.0 * frame / paced(block_.frames, plan));
    for (std::size_t n = 0; n < nodes_.size(); ++n) places_[n] = block_.way(part, from_top_[n]);
    return {nodes_, places_, {}, plan.period_s};
  }
  std::unique_ptr<fem::Tissue> tissue(const ModelPlan& plan) const {
    return plan.explicit_steps
               ? tissue::make_explicit_tissue(body_, plan.model, fem::ContactDiagonal::average,
                                              dynamics(plan), plan.period_s, plan.substeps)
               : tissue::make_tissue(body_, plan.model, fem::ContactDiagonal::average,
                                     dynamics(plan), plan.period_s, fem::Effort::computed);
  }
  const Trajectory& truth(const ModelPlan& plan, int substeps);
  void look(std::span<const double> u, Trajectory& truth) const;

  MovedBlock block_;
  fem::Body body_;
  tissue::ElasticBody elastic_{body_, tissue::LawKind::linear};  // for the elements' shapes
  std::vector<int> nodes_;
  std::vector<Vector3d> from_top_, places_;
  // By what they depend on: the law, the pace, the substeps, the scheme and its step.
  std::map<std::tuple<std::string, int, int, fem::Scheme, double>, Trajectory> truths_;
};

void LedBlock::look(std::span<const double> u, Trajectory& truth) const {
  const std::vector<double> full = body_.expand(u);
  std::vector<double> forces(full.size());
  truth.least_determinant = std::min(truth.least_determinant,
                                     elastic_.internal_forces(full, forces).smallest_determinant);
}

const Trajectory& LedBlock::truth(const ModelPlan& plan, int substeps) {
  const auto [found, is_new] = truths_.try_emplace(
      {std::string(name(plan.model)), plan.slower, substeps, plan.scheme, plan.period_s});
  Trajectory& truth = found->second;
  if (!is_new) return truth;
  const std::unique_ptr<fem::ReferenceModel> run =
      substeps > 0
          ? tissue::make_fine_steps(body_, plan.model, dynamics(plan), plan.period_s, substeps, 1)
          : tissue::make_reference(body_, plan.model, dynamics(plan), plan.period_s, 1);
  for (int frame = 1; frame <= frames(plan); ++frame) {
    run->step(hold(frame, plan));
    truth.displacement.emplace_back(run->displacement().begin(), run->displacement().end());
    look(run->displacement(), truth);
  }
  truth.unsolved = run->unsolved();
  return truth;
}

ModelOutcome LedBlock::attempt(const ModelPlan& plan) {
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
  outcome.least_determinant = truth.least_determinant;
  outcome.error = deviation.relative();
  if (const host::RenewalCounts* renewals = run->computation().renewals()) {
    outcome.renewals = *renewals;
  }
  if (steps != nullptr) {
    outcome.least_limit_s = steps->least_limit_s();
    outcome.substeps = steps->substeps();
  }
  if (outcome.unsolved > 0 || !outcome.error || !(*outcome.error <= kBound)) {
    outcome.reference.raise(Flag::not_converged);
  }
  return outcome;
}

MovedBlock with_ratio(MovedBlock block, double poisson_ratio) {
  block.poisson_ratio = poisson_ratio;
  return block;
}

}  // namespace

fem::Body body_of(const MovedBlock& block) {
  mesh::TetMesh mesh =
      fem::structured_box({0.02, 0.02, kCell * block.layers}, {4, 4, block.layers});
  const std::vector<int> clamped = lowest(mesh);
  const fem::Material material{.young_modulus_pa = block.young_modulus_pa,
                               .poisson_ratio = block.poisson_ratio};
  fem::Material stiff = material;
  stiff.young_modulus_pa *= block.contrast;
  std::vector<int> of_element;
  for (const std::array<int, 4>& nodes : mesh.tetrahedra) {
    const bool low =
        std::ranges::all_of(nodes, [&](int n) { return mesh.nodes[at(n)].z() <= 1.5 * kCell; });
    of_element.push_back(low && block.contrast != 1 ? 1 : 0);
  }
  return {std::move(mesh), fem::Materials({material, stiff}, of_element), clamped,
          fem::AnchorTreatment::removed};
}

Vector3d strike(double part, const Vector3d& /*node*/) { return {0, 0, -5e-3 * part}; }
Vector3d through(double part, const Vector3d& /*node*/) { return {0, 0, -1.3 * kCell * part}; }
Vector3d press(double part, const Vector3d& /*node*/) { return {0, 0, -2e-3 * part}; }
Vector3d press_a_little(double part, const Vector3d& /*node*/) { return {0, 0, -2e-4 * part}; }
Vector3d onto_the_floor(double part, const Vector3d& /*node*/) { return {0, 0, -kCell * part}; }
Vector3d turn(double part, const Vector3d& node) {
  const double angle = std::numbers::pi / 2 * part;
  return {std::cos(angle) * node.x() - std::sin(angle) * node.y() - node.x(),
          std::sin(angle) * node.x() + std::cos(angle) * node.y() - node.y(), 0};
}

ModelCase made(std::string name, std::string expected, Ending ending, std::optional<Flag> flag,
               const ModelPlan& plan, const MovedBlock& block) {
  return {
      std::move(name),
      std::move(expected),
      ending,
      flag,
      plan,
      [as_given = std::make_shared<LedBlock>(block),
       unlocked = std::make_shared<LedBlock>(with_ratio(block, kUnlocked))](const ModelPlan& with) {
        return (with.poisson_ratio == kUnlocked ? unlocked : as_given)->attempt(with);
      }};
}

}  // namespace hvp::tables
