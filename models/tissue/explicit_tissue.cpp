#include "models/tissue/explicit_tissue.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/index.h"
#include "models/tissue/elastic_body.h"
#include "models/tissue/stable_step.h"

namespace hvp::tissue {

namespace {

bool is_linear(const PotentialBody& body) {
  const auto* elastic = dynamic_cast<const ElasticBody*>(&body);
  return elastic != nullptr && elastic->kind() == LawKind::linear;
}

double limit_at_rest(const PotentialBody& body, const fem::Dynamics& dynamics) {
  if (dynamics.mass != fem::MassKind::lumped) {
    throw InputError("dynamics.mass",
                     "explicit steps divide by the mass of each node: expected \"lumped\"");
  }
  const FrequencyBounds bounds = largest_frequency(body, body.body().initial_displacement());
  if (dynamics.rayleigh_stiffness > 0) {
    throw InputError(
        "dynamics.rayleigh_stiffness",
        fmt::format("explicit steps know the velocity a substep late, so that stiffness damping "
                    "would take the longest stable one from {:.4g} to {:.4g} ms: expected \"0 s\"",
                    1e3 * bounds.stable_step_s(),
                    1e3 * lagged_damping_step(bounds.at_most, dynamics.rayleigh_stiffness)));
  }
  return bounds.stable_step_s();
}

int number_of_substeps(int asked, double period_s, double limit_s) {
  if (asked == 0) {
    return std::max(1, static_cast<int>(std::ceil(period_s / (ExplicitTissue::kShare * limit_s))));
  }
  if (period_s / asked < limit_s) return asked;
  throw InputError("host.substeps",
                   fmt::format("{} a frame are of {:.4g} ms, and at rest the body is stable below "
                               "{:.4g} ms: expected at least {}, or 0 to leave it open",
                               asked, 1e3 * period_s / asked, 1e3 * limit_s,
                               static_cast<int>(period_s / limit_s) + 1));
}

}  // namespace

ExplicitTissue::ExplicitTissue(std::unique_ptr<PotentialBody> body, fem::ContactDiagonal diagonal,
                               const fem::Dynamics& dynamics, double period_s, int substeps)
    : body_(std::move(body)),
      linear_(is_linear(*body_)),
      constraint_(body_->body().stiffness(), diagonal),
      limit_at_rest_(limit_at_rest(*body_, dynamics)),
      substeps_(number_of_substeps(substeps, period_s, limit_at_rest_)),
      steps_(*body_, body_->body().dead_load(), dynamics.rayleigh_mass, period_s / substeps_),
      watch_(*body_, steps_.mass()),
      contact_forces_(body_->body().active_nodes()),
      load_(body_->body().dead_load()),
      initial_(body_->body().initial_displacement()),
      velocity_(initial_.size(), 0.0),
      full_(3 * body_->body().mesh().nodes.size()),
      forces_(full_.size()) {
  std::vector<double> q(initial_.size());
  evaluate(initial_, q);
  // A look at the limit evaluates the forces once more.
  step_operations_ = substeps_ * (evaluate_operations_ + steps_.update_operations().total()) +
                     evaluate_operations_ + watch_.operations_beside_forces().total();
}

void ExplicitTissue::hold(const fem::Hold& hold) {
  held_.keep(hold);
  if (hold.let_go.empty() && !fading_) return;
  load_ = body_->body().dead_load();
  contact_forces_.add_to(hold.let_go, load_);
  fading_ = !hold.let_go.empty();
  steps_.set_load(load_);
}

double ExplicitTissue::hold_operations() const {
  return 6.0 * static_cast<double>(held_.hold().let_go.size());
}

fem::StepsFound ExplicitTissue::step() {
  const Substeps done = steps_.step(substeps_, held_.hold());
  steps_.velocity(velocity_);
  // Nodes in contact count as free: they may be let go in the next frame, which is stable for less.
  watch_.look(steps_.displacement(), steps_.internal_forces());
  least_limit_ = std::min(least_limit_, watch_.stable_step_s());
  return {.inverted = done.inverted + done.undefined - done.overflown,
          .overflown = done.overflown,
          .complete = done.complete(),
          .over_limit = done.exploded || steps_.substep_s() > watch_.stable_step_s(),
          .operations = done.operations.total() + watch_.operations().total()};
}

void ExplicitTissue::forces(std::span<const double> /*u*/, std::span<Eigen::Vector3d> of_probes) {
  const fem::Hold hold = held_.hold();
  if (hold.present()) steps_.reaction(hold.nodes, contact_forces_);
  contact_forces_.sum(hold, of_probes);
}

double ExplicitTissue::force_operations() const {
  const fem::Hold hold = held_.hold();
  return hold_operations() + (hold.present() ? steps_.reaction_flops(hold.nodes) : 0);
}

fem::ElementsFound ExplicitTissue::evaluate(std::span<const double> u, std::span<double> q) {
  body_->body().expand(u, full_);
  const Deformation deformation = body_->internal_forces(full_, forces_);
  const std::vector<int>& node = body_->body().node_of_active();
  for (std::size_t a = 0; a < node.size(); ++a) {
    std::copy_n(&forces_[3 * at(node[a])], 3, &q[3 * a]);
  }
  evaluate_operations_ = deformation.operations.total();
  return {deformation.inverted, deformation.undefined, deformation.overflown};
}

fem::ElementsFound ExplicitTissue::follow(std::span<const int> /*nodes*/,
                                          std::span<const Eigen::Vector3d> /*moved*/,
                                          std::span<const double> u, std::span<double> q) {
  return evaluate(u, q);
}

FineSteps::FineSteps(std::unique_ptr<PotentialBody> body, const fem::Dynamics& dynamics,
                     double period_s, int substeps, std::size_t probes)
    : tissue_(std::move(body), fem::ContactDiagonal::average, dynamics, period_s,
              kFiner * substeps),
      of_probes_(probes, Eigen::Vector3d::Zero()) {}

void FineSteps::solve(const fem::Hold& hold) {
  tissue_.hold(hold);
  const fem::StepsFound found = tissue_.step();
  if (!found.complete) ++unsolved_;
  if (found.overflown > 0) ++overflown_;
  tissue_.forces(tissue_.displacement(), of_probes_);
}

}  // namespace hvp::tissue
