#include "models/tissue/nonlinear_tissue.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "models/config/input_error.h"
#include "models/fem/assembly.h"
#include "models/index.h"
#include "models/tissue/noise.h"

namespace hvp::tissue {

namespace {

// Damping is a matter of the elements here, not of the matrix K.
std::optional<fem::Dynamics> without_stiffness_damping(std::optional<fem::Dynamics> dynamics) {
  if (dynamics) dynamics->rayleigh_stiffness = 0;
  return dynamics;
}

sparse::BlockMatrix system_at_rest(const fem::Body& body,
                                   const std::optional<fem::Dynamics>& dynamics, double period_s,
                                   const std::optional<PronySeries>& series) {
  if (series) {
    sparse::BlockMatrix matrix = body.stiffness();
    for (double& entry : matrix.value) entry *= series->stiffness_factor();
    if (dynamics) {
      fem::Newmark(body.stiffness(), body.mass(dynamics->mass), *dynamics, period_s)
          .add_inertia_to(matrix);
    }
    return matrix;
  }
  if (!dynamics) return body.stiffness();
  return fem::Newmark(body.stiffness(), body.mass(dynamics->mass), *dynamics, period_s)
      .effective_matrix();
}

std::optional<PronySeries> series_of(const Constitution& constitution,
                                     const std::optional<fem::Dynamics>& dynamics,
                                     double period_s) {
  if (constitution.prony.empty()) return std::nullopt;
  if (dynamics && dynamics->rayleigh_stiffness > 0) {
    throw InputError("dynamics.rayleigh_stiffness",
                     "the forces of object.model.prony relax, which damps already: expected "
                     "\"0 s\"");
  }
  return std::make_optional<PronySeries>(constitution.prony, period_s);
}

// M̂'s share of an element's point at each of its corners, over the point's part of the mass.
double inertia_support(const fem::Body& body, const std::optional<fem::Dynamics>& dynamics,
                       const fem::Newmark* integration) {
  if (integration == nullptr) return 0;
  return least_inertia_share(body.elements(), dynamics->mass) * integration->inertia_weight();
}

fem::ElementsFound found(const Deformation& deformation) {
  return {deformation.inverted, deformation.undefined, deformation.overflown};
}

}  // namespace

NonlinearTissue::NonlinearTissue(const fem::Body& body, const Constitution& constitution,
                                 fem::ContactDiagonal diagonal,
                                 const std::optional<fem::Dynamics>& dynamics, double period_s)
    : body_(body),
      elastic_(body, constitution.law, constitution.parameters),
      damping_s_(dynamics ? dynamics->rayleigh_stiffness : 0),
      integrator_(body, body.dead_load(), without_stiffness_damping(dynamics), period_s),
      series_(series_of(constitution, dynamics, period_s)),
      matrix_(system_at_rest(body, dynamics, period_s, series_)),
      support_(inertia_support(body, dynamics, integrator_.newmark())),
      constraint_(matrix_, diagonal),
      kept_diagonal_(at(body.active_nodes()), 0.0),
      forces_n_(3 * body.mesh().nodes.size(), 0.0),
      u_full_(forces_n_),
      v_full_(forces_n_),
      reaction_n_(forces_n_),
      u_reaction_(forces_n_),
      v_reaction_(forces_n_),
      change_(forces_n_),
      rounding_n_(rounding_of_forces(body)),
      frames_(damped() ? elastic_.points() : 0),
      chosen_(body.mesh().tetrahedra.size(), 0) {
  elements_.reserve(chosen_.size());
  for (int a = 0; a < body.active_nodes(); ++a) {
    if (!body.held(body.node_of_active()[at(a)])) continue;
    const auto own = static_cast<std::size_t>(body.stiffness().find(a, a));
    kept_diagonal_[at(a)] = body.stiffness().block(own)[0];
  }
  // At rest, for what the operations are before the first frame.
  const std::span<const double> initial = initial_displacement();
  std::vector<double> q(initial.size());
  if (series_) {
    // What is held displaced from the start has been there for ever.
    relaxed_n_ = forces_n_;
    body_.expand(initial, u_full_);
    static_cast<void>(elastic_.internal_forces(u_full_, forces_n_));
    memory_.emplace(*series_, forces_n_.size());
    memory_->rest(forces_n_);
    memory_operations_ = memory_->commit(forces_n_).total();
    memory_->rest(forces_n_);
  }
  // What an evaluation takes before the first frame is that of a body strained by some per cent:
  // the corotational law's rotation takes longer than at rest.
  evaluate(strained(), q);
  const double typical = evaluate_operations_;
  evaluate(initial, q);
  evaluate_operations_ = std::max(evaluate_operations_, typical);
  if (damped())
    damping_operations_ =
        elastic_.add_damping(frames_, motion(u_full_, change_), forces_n_).total();
  stale_ = true;
  if (between_ends()) {
    // At rest: damping has no part in it.
    at_end_.resize(initial.size());
    static_cast<void>(elastic_.internal_forces(u_full_, forces_n_));
    collect_elements(initial, at_end_);
    integrator_.start(at_end_);
  }
}

// The body strained by some per cent.
std::vector<double> NonlinearTissue::strained() const {
  const std::span<const double> initial = initial_displacement();
  std::vector<double> displaced(initial.begin(), initial.end());
  const double size = (body_.mesh().quadratic() ? 0.01 : 0.02) *
                      std::cbrt(fem::element_geometry(body_.mesh(), 0).volume());
  std::uint32_t noise = kFirstNoise;
  for (double& u : displaced) u += size * next_noise(noise);
  return displaced;
}

Motion NonlinearTissue::motion(std::span<const double> u, std::span<const double> v) const {
  return {u, damped() ? v : std::span<const double>(), damping_s_};
}

// ṽ + c·u at the nodes that move by themselves; the others rest.
void NonlinearTissue::expand_velocity(std::span<const double> u, std::span<double> v) const {
  if (!damped()) return;
  const std::span<const double> predicted = integrator_.newmark()->predicted_velocity();
  const double weight = integrator_.newmark()->velocity_weight();
  for (std::size_t a = 0; a < kept_diagonal_.size(); ++a) {
    const auto node = at(body_.node_of_active()[a]);
    if (body_.held(static_cast<int>(node))) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      v[3 * node + i] = predicted[3 * a + i] + weight * u[3 * a + i];
    }
  }
}

// The elements' forces over active nodes.
void NonlinearTissue::collect_elements(std::span<const double> u, std::span<double> q) {
  if (memory_) memory_->forces(forces_n_, relaxed_n_);
  const std::vector<double>& forces = memory_ ? relaxed_n_ : forces_n_;
  for (std::size_t a = 0; a < kept_diagonal_.size(); ++a) {
    const auto node = at(body_.node_of_active()[a]);
    for (std::size_t i = 0; i < 3; ++i) {
      q[3 * a + i] = body_.held(static_cast<int>(node)) ? kept_diagonal_[a] * u[3 * a + i]
                                                        : forces[3 * node + i];
    }
  }
}

void NonlinearTissue::collect(std::span<const double> u, std::span<double> q) {
  collect_elements(u, q);
  if (integrator_.newmark() != nullptr) integrator_.newmark()->add_inertia(u, q);
}

double NonlinearTissue::collect_operations() const {
  const auto rows = 3.0 * static_cast<double>(kept_diagonal_.size());
  const double velocity = damped() || memory_ ? 2 * rows : 0;
  return integrator_.newmark() == nullptr ? velocity
                                          : velocity + integrator_.newmark()->inertia_flops();
}

fem::ElementsFound NonlinearTissue::evaluate(std::span<const double> u, std::span<double> q) {
  body_.expand(u, u_full_);
  expand_velocity(u, v_full_);
  const Deformation deformation = elastic_.forces(motion(u_full_, v_full_), forces_n_, frames_);
  stale_ = !deformation.defined();
  collect(u, q);
  evaluate_operations_ = deformation.operations.total() + collect_operations();
  return found(deformation);
}

void NonlinearTissue::choose_elements_at(std::span<const int> nodes) {
  elements_.clear();
  for (const int active : nodes) {
    for (const int e : elastic_.elements_at(body_.node_of_active()[at(active)])) {
      if (std::exchange(chosen_[at(e)], 1) == 0) elements_.push_back(e);
    }
  }
  std::ranges::sort(elements_);
  for (const int e : elements_) chosen_[at(e)] = 0;
}

// True if u is that of the forces but for `nodes`: the solve may start elsewhere than at the last
// solution.
bool NonlinearTissue::elsewhere_as_known(std::span<const int> nodes,
                                         std::span<const double> u) const {
  auto next = nodes.begin();
  for (std::size_t a = 0; a < kept_diagonal_.size(); ++a) {
    const auto node = at(body_.node_of_active()[a]);
    if (next != nodes.end() && at(*next) == a) {
      ++next;
    } else if (!body_.held(static_cast<int>(node)) &&
               !std::equal(&u[3 * a], &u[3 * a] + 3, &u_full_[3 * node])) {
      return false;
    }
  }
  return true;
}

// Visits the elements at those nodes twice, before and after. What that loses to rounding is gone
// with the next evaluate(), once a frame.
fem::ElementsFound NonlinearTissue::follow(std::span<const int> nodes,
                                           std::span<const Eigen::Vector3d> /*moved*/,
                                           std::span<const double> u, std::span<double> q) {
  if (stale_ || !elsewhere_as_known(nodes, u)) {
    const fem::ElementsFound all = evaluate(u, q);
    follow_operations_ = evaluate_operations_;
    return all;
  }
  choose_elements_at(nodes);
  Deformation deformation = elastic_.add_forces(elements_, motion(u_full_, v_full_), -1, forces_n_);
  double operations = deformation.operations.total();
  body_.expand(u, u_full_);
  expand_velocity(u, v_full_);
  deformation = elastic_.add_forces(elements_, motion(u_full_, v_full_), 1, forces_n_);
  operations += deformation.operations.total();
  stale_ = !deformation.defined();
  collect(u, q);
  follow_operations_ = operations + collect_operations();
  return found(deformation);
}

void NonlinearTissue::hold(const fem::Hold& hold) {
  integrator_.hold(hold);
  if (integrator_.predicted_anew()) stale_ = true;
}

// Visits the elements at the contact's nodes: nobody waits for the others before the force goes
// out.
void NonlinearTissue::forces(std::span<const double> u, std::span<Eigen::Vector3d> of_probes) {
  const fem::Hold hold = integrator_.held();
  reaction_operations_ = 0;
  if (hold.present()) {
    body_.expand(u, u_reaction_);
    expand_velocity(u, v_reaction_);
    choose_elements_at(hold.nodes);
    std::ranges::fill(reaction_n_, 0.0);
    const Deformation deformation =
        elastic_.add_forces(elements_, motion(u_reaction_, v_reaction_), 1, reaction_n_);
    // Elsewhere it is no force of anything, and nobody reads it.
    if (memory_) memory_->forces(reaction_n_, reaction_n_);
    const fem::Newmark* newmark = integrator_.newmark();
    // f̂ has more than what acts at the step's end, where its equation is not that of the end.
    const std::span<const double> f =
        between_ends() ? std::span<const double>(body_.dead_load()) : integrator_.external_force();
    for (const int active : hold.nodes) {
      const auto node = at(body_.node_of_active()[at(active)]);
      Eigen::Vector3d force = Eigen::Map<const Eigen::Vector3d>(&reaction_n_[3 * node]);
      if (newmark != nullptr) {
        force += between_ends() ? newmark->end_inertia(u, active) : newmark->inertia(u, active);
      }
      force -= Eigen::Map<const Eigen::Vector3d>(&f[3 * at(active)]);
      integrator_.contact_forces().set(active, force);
    }
    // Inertia, velocities, f, and the sum over nodes.
    reaction_operations_ =
        deformation.operations.total() + 27 * static_cast<double>(hold.nodes.size());
    if (between_ends()) reaction_operations_ += newmark->end_inertia_flops(hold.nodes);
  }
  integrator_.sum_forces(of_probes);
}

// Brings the elements' forces to u, with the velocities of this step. The last evaluation may have
// been of a step that was refused.
void NonlinearTissue::find_forces_at(std::span<const double> u) {
  refind_operations_ = 0;
  if (!stale_ && elsewhere_as_known({}, u)) return;
  body_.expand(u, u_full_);
  expand_velocity(u, v_full_);
  const Deformation deformation = elastic_.forces(motion(u_full_, v_full_), forces_n_, frames_);
  stale_ = !deformation.defined();
  refind_operations_ = deformation.operations.total();
}

// The damping forces of the next time step differ from this one's by those of the change in ṽ.
void NonlinearTissue::advance(std::span<const double> u) {
  if (between_ends()) {
    find_forces_at(u);
    // Without forces at u the last ones stay.
    if (!stale_) collect_elements(u, at_end_);
    integrator_.advance(u, at_end_);
  } else {
    integrator_.advance(u);
  }
  if (memory_) {
    if (stale_ || !elsewhere_as_known({}, u)) {
      body_.expand(u, u_full_);
      stale_ = !elastic_.internal_forces(u_full_, forces_n_).defined();
    }
    memory_operations_ = memory_->commit(forces_n_).total();
  }
  if (!damped() || stale_) return;
  // The step may have been refused after the last evaluation.
  stale_ = !elsewhere_as_known({}, u);
  if (stale_) return;
  change_ = v_full_;
  expand_velocity(u, v_full_);
  for (std::size_t i = 0; i < change_.size(); ++i) change_[i] = v_full_[i] - change_[i];
  damping_operations_ = elastic_.add_damping(frames_, motion(u_full_, change_), forces_n_).total() +
                        3 * static_cast<double>(change_.size());
}

double NonlinearTissue::force_operations() const {
  return integrator_.fading_operations() + reaction_operations_;
}

double NonlinearTissue::advance_operations() const {
  return integrator_.advance_operations() + (damped() ? damping_operations_ : 0) +
         memory_operations_ + refind_operations_;
}

fem::ElementsFound NonlinearTissue::tangent(sparse::BlockMatrix& k) const {
  const Deformation deformation = elastic_.tangent(u_full_, Linearisation::exact, k);
  add_to_elastic(k);
  return found(deformation);
}

// Relaxation, damping and inertia, to the derivative of the elements' forces. Gives the operations.
double NonlinearTissue::add_to_elastic(sparse::BlockMatrix& k) const {
  double operations = 0;
  if (series_) {
    for (double& entry : k.value) entry *= relaxation_factor();
    operations += static_cast<double>(k.value.size());
  }
  const fem::Newmark* newmark = integrator_.newmark();
  if (newmark == nullptr) return operations;
  if (damped()) {
    operations +=
        elastic_.add_damping_tangent(frames_, damping_s_, newmark->velocity_weight(), k).total();
  }
  newmark->add_inertia_to(k);
  return operations + newmark->inertia_flops();
}

fem::FormedSystem NonlinearTissue::form(std::span<const double> u, sparse::BlockMatrix& a) {
  body_.expand(u, u_reaction_);
  const Deformation deformation = elastic_.supported_tangent(u_reaction_, support_, a);
  double operations = deformation.operations.total();
  if (!deformation.defined()) return {false, 0, operations};
  operations += add_to_elastic(a);
  return {true, deformation.projected, operations};
}

double NonlinearTissue::typical_operations() {
  // Strained by less: noise of some per cent makes more elements indefinite than a probe does.
  constexpr double kShare = 0.1;
  std::vector<double> u = strained();
  const std::span<const double> initial = initial_displacement();
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = initial[i] + kShare * (u[i] - initial[i]);
  sparse::BlockMatrix formed = matrix_;
  return form(u, formed).operations;
}

void NonlinearTissue::take(const sparse::BlockMatrix& a) {
  std::ranges::copy(a.value, matrix_.value.begin());
  ++revision_;
}

double NonlinearTissue::energy() const {
  double energy_j = 0;
  static_cast<void>(elastic_.energy(u_full_, energy_j));
  return energy_j;
}

}  // namespace hvp::tissue
