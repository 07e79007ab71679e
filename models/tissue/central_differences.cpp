#include "models/tissue/central_differences.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::tissue {
namespace {

constexpr Operations kUpdateOfNode = {.add_multiply = 3 * 5};
constexpr Operations kMoveOfNode = {.add_multiply = 3 * 4};
constexpr double kReactionOfNode = 3 * 4;

void note(Substeps& substeps, const Deformation& found) {
  substeps.operations += found.operations;
  // One that is no number counts as the smallest.
  if (!(found.smallest_determinant >= substeps.smallest_determinant)) {
    substeps.smallest_determinant = found.smallest_determinant;
  }
  substeps.inverted = std::max(substeps.inverted, found.inverted);
}

double diagonal_of(const mesh::TetMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& node : mesh.nodes) box.extend(node);
  return box.diagonal().norm();
}

bool all_finite(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) sum += 0 * value;  // NaN where the value is not finite
  return sum == 0;
}

}  // namespace

CentralDifferences::CentralDifferences(const PotentialBody& body, std::span<const double> load,
                                       double rayleigh_mass_per_s, double substep_s)
    : body_(body),
      damping_(rayleigh_mass_per_s),
      substep_(substep_s),
      reach_(diagonal_of(body.body().mesh())) {
  if (!(substep_s > 0) || !std::isfinite(substep_s)) {
    throw InputError(
        fmt::format("the substep is {} s; expected a finite value above 0", substep_s));
  }
  if (!(damping_ >= 0) || !std::isfinite(damping_)) {
    throw InputError(fmt::format("the mass damping is {} 1/s; expected a finite value, 0 or more",
                                 rayleigh_mass_per_s));
  }
  const fem::Body& of = body.body();
  if (load.size() != of.load().size()) {
    throw InputError(
        fmt::format("the load has {} entries; expected {}", load.size(), of.load().size()));
  }
  const double late = damping_ * substep_ / 2;
  kept_ = (1 - late) / (1 + late);
  const sparse::BlockMatrix mass = of.mass(fem::MassKind::lumped);
  for (int a = 0; a < of.active_nodes(); ++a) {
    mass_.push_back(mass.block(static_cast<std::size_t>(mass.find(a, a)))[0]);
    gain_.push_back(substep_ * substep_ / (mass_.back() * (1 + late)));
    held_.push_back(of.held(of.node_of_active()[at(a)]) ? 1 : 0);
  }
  load_.assign(load.begin(), load.end());
  in_contact_.resize(mass_.size());
  from_.resize(mass_.size());
  for (std::vector<double>* state : {&u_, &went_, &next_u_, &next_went_}) {
    state->assign(load.size(), 0.0);
  }
  for (std::vector<double>* all : {&full_, &internal_, &next_internal_}) {
    all->assign(3 * of.mesh().nodes.size(), 0.0);
  }
  const std::vector<double> u = of.initial_displacement();
  set_state(u, went_);
}

void CentralDifferences::set_load(std::span<const double> load) {
  assert(load.size() == load_.size());
  std::copy(load.begin(), load.end(), load_.begin());
}

void CentralDifferences::set_state(std::span<const double> u, std::span<const double> v) {
  assert(u.size() == u_.size() && v.size() == u_.size());
  body_.body().expand(u, full_);
  if (const Deformation found = body_.internal_forces(full_, internal_); !found.defined()) {
    throw InputError(
        fmt::format("the internal forces of {} elements are not defined at the start; expected all",
                    found.undefined));
  }
  std::fill(in_contact_.begin(), in_contact_.end(), 0);
  for (std::size_t a = 0; a < mass_.size(); ++a) {
    const std::size_t node = at(body_.body().node_of_active()[a]);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t k = 3 * a + i;
      u_[k] = full_[3 * node + i];
      const double acceleration = (load_[k] - internal_[3 * node + i]) / mass_[a] - damping_ * v[k];
      went_[k] = held_[a] ? 0 : substep_ * v[k] - substep_ * substep_ / 2 * acceleration;
    }
  }
  // Held nodes that the body keeps stay where they are now.
  next_u_ = u_;
  next_went_ = went_;
}

Substeps CentralDifferences::step(int substeps, const fem::Hold& hold) {
  Substeps result{.asked = substeps};
  const fem::Body& body = body_.body();
  std::fill(in_contact_.begin(), in_contact_.end(), 0);
  for (std::size_t n = 0; n < hold.nodes.size(); ++n) {
    const std::size_t a = at(hold.nodes[n]);
    in_contact_[a] = held_[a] ? 0 : 1;
    from_[n] = Eigen::Map<const Eigen::Vector3d>(&u_[3 * a]);
  }
  for (int s = 1; s <= substeps; ++s) {
    for (std::size_t a = 0; a < mass_.size(); ++a) {
      if (held_[a] || in_contact_[a]) continue;
      const double* internal = &internal_[3 * at(body.node_of_active()[a])];
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t k = 3 * a + i;
        next_went_[k] = kept_ * went_[k] + gain_[a] * (load_[k] - internal[i]);
        next_u_[k] = u_[k] + next_went_[k];
      }
    }
    const double share = static_cast<double>(s) / substeps;
    for (std::size_t n = 0; n < hold.nodes.size(); ++n) {
      const std::size_t a = at(hold.nodes[n]);
      if (held_[a]) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t k = 3 * a + i;
        const double from = from_[n][static_cast<int>(i)];
        const double to = hold.displacement[n][static_cast<int>(i)];
        next_u_[k] = s == substeps ? to : from + share * (to - from);
        next_went_[k] = next_u_[k] - u_[k];
      }
    }
    result.operations += update_operations() +
                         static_cast<double>(hold.nodes.size()) * kMoveOfNode +
                         (hold.present() ? Operations{.divisions = 1} : Operations());
    if (!within_reach()) {
      result.exploded = true;
      break;
    }
    body.expand(next_u_, full_);
    const Deformation found = body_.internal_forces(full_, next_internal_);
    note(result, found);
    result.exploded = found.defined() && !all_finite(next_internal_);
    if (!found.defined() || result.exploded) {
      result.undefined = found.undefined;
      result.overflown = found.overflown;
      body.expand(u_, full_);
      break;
    }
    u_.swap(next_u_);
    went_.swap(next_went_);
    internal_.swap(next_internal_);
    ++result.done;
  }
  return result;
}

// True if every free node moves by no more than reach_ in the next substep.
bool CentralDifferences::within_reach() const {
  double largest = 0;
  for (std::size_t a = 0; a < mass_.size(); ++a) {
    if (held_[a] || in_contact_[a]) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const double went = std::abs(next_went_[3 * a + i]);
      if (!(went <= largest)) largest = went;
    }
  }
  return largest <= reach_;
}

double CentralDifferences::velocity_of(std::size_t node, std::size_t dof) const {
  if (held_[node]) return 0;
  const double mean = went_[dof] / substep_;
  if (in_contact_[node]) return mean;
  const double force =
      load_[dof] - internal_[3 * at(body_.body().node_of_active()[node]) + dof % 3];
  return (mean + substep_ / 2 * force / mass_[node]) / (1 + damping_ * substep_ / 2);
}

void CentralDifferences::velocity(std::span<double> v) const {
  assert(v.size() == u_.size());
  for (std::size_t k = 0; k < v.size(); ++k) v[k] = velocity_of(k / 3, k);
}

double CentralDifferences::kinetic_energy() const {
  double energy = 0;
  for (std::size_t k = 0; k < u_.size(); ++k) {
    const double v = velocity_of(k / 3, k);
    energy += mass_[k / 3] / 2 * v * v;
  }
  return energy;
}

double CentralDifferences::strain_energy() const {
  double energy = 0;
  // The internal forces of this state were defined, and so is its energy.
  static_cast<void>(body_.energy(full_, energy));
  return energy;
}

double CentralDifferences::work_of_load() const {
  double work = 0;
  for (std::size_t k = 0; k < u_.size(); ++k) work += held_[k / 3] ? 0 : load_[k] * u_[k];
  return work;
}

Eigen::Vector3d CentralDifferences::reaction_of(int node) const {
  const std::size_t a = at(node);
  const std::size_t in_mesh = at(body_.body().node_of_active()[a]);
  Eigen::Vector3d force;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = 3 * a + i;
    force[static_cast<int>(i)] =
        internal_[3 * in_mesh + i] + damping_ * mass_[a] * velocity_of(a, k) - load_[k];
  }
  return force;
}

Eigen::Vector3d CentralDifferences::reaction(std::span<const int> nodes) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int node : nodes) sum += reaction_of(node);
  return sum;
}

Eigen::Vector3d CentralDifferences::reaction(std::span<const int> nodes,
                                             fem::HeldForces& forces) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int node : nodes) {
    const Eigen::Vector3d force = reaction_of(node);
    forces.set(node, force);
    sum += force;
  }
  return sum;
}

double CentralDifferences::reaction_flops(std::span<const int> nodes) const {
  return kReactionOfNode * static_cast<double>(nodes.size());
}

Operations CentralDifferences::update_operations() const {
  return static_cast<double>(mass_.size()) * kUpdateOfNode;
}

}  // namespace hvp::tissue
